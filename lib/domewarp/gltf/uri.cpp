// SPDX-License-Identifier: Apache-2.0
#include "domewarp/gltf/uri.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <system_error>

#include "domewarp/core/errors.h"

namespace domewarp::gltf {

namespace fs = std::filesystem;

namespace {

int hex_digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

int base64_digit(char c) {
  if (c >= 'A' && c <= 'Z') return c - 'A';
  if (c >= 'a' && c <= 'z') return c - 'a' + 26;
  if (c >= '0' && c <= '9') return c - '0' + 52;
  if (c == '+' || c == '-') return 62;
  if (c == '/' || c == '_') return 63;
  return -1;
}

std::optional<std::vector<std::uint8_t>> base64_decode(std::string_view text) {
  while (!text.empty() && text.back() == '=') text.remove_suffix(1);
  if (text.size() % 4 == 1) return std::nullopt;
  std::vector<std::uint8_t> bytes;
  bytes.reserve(text.size() * 3 / 4);
  std::uint32_t bits = 0;
  int count = 0;
  for (const char c : text) {
    const int digit = base64_digit(c);
    if (digit < 0) return std::nullopt;
    bits = (bits << 6) | static_cast<std::uint32_t>(digit);
    count += 6;
    if (count < 8) continue;
    count -= 8;
    bytes.push_back(static_cast<std::uint8_t>(bits >> count));
  }
  return bytes;
}

/// "http://...", "file:...", "C:..." and also ":...", which is not a relative path either.
bool has_scheme(std::string_view uri) {
  const std::size_t colon = uri.find(':');
  return colon != std::string_view::npos && uri.find_first_of("/?#") > colon;
}

bool lies_within(const fs::path& inner, const fs::path& outer) {
  const auto [end, rest] = std::mismatch(outer.begin(), outer.end(), inner.begin(), inner.end());
  return end == outer.end() && rest != inner.end();
}

/// Through every link, for as much of the path as exists.
fs::path real_path(const fs::path& path) {
  std::error_code status;
  const fs::path real = fs::weakly_canonical(path, status);
  return status ? fs::absolute(path).lexically_normal() : real;
}

} // namespace

bool is_data_uri(std::string_view uri) {
  return uri.starts_with("data:");
}

std::optional<std::string> percent_decode(std::string_view text) {
  std::string decoded;
  decoded.reserve(text.size());
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '%') {
      decoded += text[i];
      continue;
    }
    const int high = i + 2 < text.size() ? hex_digit(text[i + 1]) : -1;
    const int low = i + 2 < text.size() ? hex_digit(text[i + 2]) : -1;
    if (high < 0 || low < 0 || high + low == 0) return std::nullopt;
    decoded += static_cast<char>(high * 16 + low);
    i += 2;
  }
  return decoded;
}

std::string percent_encode(std::string_view text) {
  constexpr std::string_view digits = "0123456789ABCDEF";
  constexpr std::string_view kept = "-._~/";
  std::string encoded;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if ((byte < 128 && std::isalnum(byte)) || kept.find(c) != std::string_view::npos)
      encoded += c;
    else
      encoded += {'%', digits[byte / 16], digits[byte % 16]};
  }
  return encoded;
}

std::optional<DataUri> decode_data_uri(std::string_view uri) {
  const std::size_t comma = uri.find(',');
  if (!is_data_uri(uri) || comma == std::string_view::npos) return std::nullopt;
  const std::string_view header = uri.substr(5, comma - 5), body = uri.substr(comma + 1);
  DataUri data;
  data.mime = header.substr(0, header.find(';'));
  if (header.ends_with(";base64")) {
    std::optional<std::vector<std::uint8_t>> bytes = base64_decode(body);
    if (!bytes) return std::nullopt;
    data.bytes = std::move(*bytes);
  } else {
    const std::optional<std::string> text = percent_decode(body);
    if (!text) return std::nullopt;
    data.bytes.assign(text->begin(), text->end());
  }
  return data;
}

bool stays_inside(std::string_view path) {
  if (path.empty() || path.front() == '/' || path.find_first_of("\\:") != std::string_view::npos) return false;
  if (std::any_of(path.begin(), path.end(), [](char c) { return static_cast<unsigned char>(c) < 32; })) return false;
  const fs::path parts{path};
  return std::none_of(parts.begin(), parts.end(), [](const fs::path& part) { return part == ".."; });
}

fs::path resolve_uri(const fs::path& folder, const std::string& uri, bool allow_external) {
  const auto fail = [&](const char* defect) {
    throw Error(ErrorCode::input, "URI \"" + uri.substr(0, 200) + "\" " + defect);
  };
  std::string_view text = uri;
  if (allow_external && text.starts_with("file://")) text.remove_prefix(7);
  const std::optional<std::string> decoded = percent_decode(text);
  if (!decoded || decoded->empty()) fail("is not a valid path");
  if (has_scheme(text)) fail("is not a relative path");
  if (allow_external) return folder / *decoded;
  if (!stays_inside(*decoded)) fail("leaves the folder of the file");
  fs::path path = folder / *decoded;
  if (!lies_within(real_path(path), real_path(folder))) fail("leaves the folder of the file through a link");
  return path;
}

} // namespace domewarp::gltf
