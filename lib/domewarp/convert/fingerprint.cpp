// SPDX-License-Identifier: Apache-2.0
#include "domewarp/convert/fingerprint.h"

#include <cstdint>
#include <cstdio>
#include <fstream>
#include <string_view>
#include <system_error>
#include <vector>

#define XXH_INLINE_ALL
#include <xxhash.h>

#include "domewarp/convert/record.h"
#include "domewarp/core/errors.h"
#include "domewarp/gltf/survey.h"

namespace domewarp {

namespace {

/// XXH3, 128 bits: not cryptographic, it only has to notice change.
class Hash {
public:
  Hash() { XXH3_128bits_reset(&state_); }

  void add(std::string_view text) {
    const std::uint64_t size = text.size(); // so that "ab" "c" differs from "a" "bc"
    XXH3_128bits_update(&state_, &size, sizeof size);
    XXH3_128bits_update(&state_, text.data(), text.size());
  }

  /// @return false when the file cannot be read
  bool add_file(const std::filesystem::path& path) {
    std::error_code status;
    if (!std::filesystem::is_regular_file(path, status)) return false;
    std::ifstream in(path, std::ios::binary);
    std::vector<char> block(1 << 18);
    std::uint64_t size = 0;
    while (in.read(block.data(), static_cast<std::streamsize>(block.size())) || in.gcount() > 0) {
      XXH3_128bits_update(&state_, block.data(), static_cast<std::size_t>(in.gcount()));
      size += static_cast<std::uint64_t>(in.gcount());
    }
    XXH3_128bits_update(&state_, &size, sizeof size);
    return in.eof();
  }

  std::string digits() const {
    const XXH128_hash_t hash = XXH3_128bits_digest(&state_);
    char text[33];
    std::snprintf(text, sizeof text, "%016llx%016llx", static_cast<unsigned long long>(hash.high64), static_cast<unsigned long long>(hash.low64));
    return text;
  }

private:
  XXH3_state_t state_;
};

} // namespace

std::string fingerprint(const BatchItem& item) {
  Hash hash;
  hash.add(DOMEWARP_VERSION);
  hash.add(item.arguments);
  hash.add(to_json(item.options->convert.surface));
  std::error_code status;
  if (!std::filesystem::exists(item.input, status)) throw Error(ErrorCode::input, item.input.string() + ": no such file");
  if (!hash.add_file(item.input)) throw Error(ErrorCode::input, item.input.string() + ": cannot be read");
  for (const auto& file : survey_file(item.input, item.options->read.allow_external).side_files) {
    hash.add(hash.add_file(file) ? "read" : "missing");
  }
  return hash.digits();
}

} // namespace domewarp
