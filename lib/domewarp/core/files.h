// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace domewarp {

/// The whole file. @throws Error(input) naming the file when it cannot be opened, is a folder, or cannot be read.
std::vector<std::uint8_t> read_file(const std::filesystem::path& path);

/// Writes to a temporary name in the same folder, then renames, so that no half-written file is ever seen under `path`.
/// A symbolic link keeps pointing where it did; what is no file (a terminal, a pipe, /dev/null) is written to as it is.
/// @throws Error(output) naming the file; the temporary file is removed.
void write_file(const std::filesystem::path& path, std::span<const std::uint8_t> bytes);
void write_file(const std::filesystem::path& path, std::string_view text);

/// The same for parts that follow each other.
void write_file(const std::filesystem::path& path, std::initializer_list<std::span<const std::uint8_t>> parts);

/// Whether both names lead to one file that exists.
bool is_same_file(const std::filesystem::path& a, const std::filesystem::path& b);

/// Makes a folder and those above it where they are missing. @throws Error(output)
void make_folder(const std::filesystem::path& path);

} // namespace domewarp
