// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdexcept>
#include <string>

namespace domewarp {

/// Why something could not be done. The command line turns the code into its exit status.
enum class ErrorCode {
  usage = 1,      ///< an option or argument is wrong
  input = 2,      ///< a file cannot be read or is invalid
  unkept = 3,     ///< a promise (tolerance, parity) was not kept
  output = 4,     ///< a result cannot be written
};

/// The only exception this library throws on purpose. The message is one sentence that names the file or option, what
/// is wrong and the offending value.
class Error : public std::runtime_error {
public:
  Error(ErrorCode code, const std::string& message) : std::runtime_error(message), code_(code) {}
  ErrorCode code() const noexcept { return code_; }

private:
  ErrorCode code_;
};

} // namespace domewarp
