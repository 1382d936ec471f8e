// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace domewarp {

/// A place in a text; both count from 1, columns in characters.
struct TextPlace {
  std::size_t line = 1, column = 1;
};

/// One option of a manifest: a long option of `domewarp convert` without its dashes, and its argument as the command line
/// would have it ([1, 2, 3] is "1,2,3").
struct ManifestOption {
  enum class Kind { text, on, off }; ///< text: `value` is the argument; on: true; off: false or null, as if not given
  std::string name;
  std::string value;
  Kind kind = Kind::text;
  TextPlace place;                   ///< of the key
};

struct ManifestScene {
  std::string input;                 ///< a file or folder, relative to the folder of the manifest
  std::string output;                ///< relative to the output folder; empty: from the input
  std::vector<ManifestOption> options;
  TextPlace place;
};

struct Manifest {
  std::vector<ManifestOption> defaults;
  std::vector<ManifestScene> scenes;
};

/// Reads
///   {"defaults": {OPTION: VALUE, ...}, "scenes": ["FILE", {"input": "FILE", "output": "FILE", OPTION: VALUE, ...}, ...]}
/// Whether an option exists and its value makes sense is for the one who knows the options.
/// @param name of the manifest, for messages
/// @throws Error(input) "NAME:LINE:COLUMN: ..." for text that is no JSON, an unknown or repeated key, a value of the wrong
///         type, a scene without input
Manifest parse_manifest(std::string_view text, const std::string& name);

/// "NAME:LINE:COLUMN"
std::string to_string(const std::string& name, const TextPlace& place);

} // namespace domewarp
