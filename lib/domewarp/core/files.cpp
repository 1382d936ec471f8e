// SPDX-License-Identifier: Apache-2.0
#include "domewarp/core/files.h"

#include <cerrno>
#include <cstring>
#include <fstream>
#include <system_error>

#include <sys/stat.h>
#include <unistd.h>

#include "domewarp/core/errors.h"

namespace domewarp {

namespace fs = std::filesystem;

std::vector<std::uint8_t> read_file(const fs::path& path) {
  std::error_code status;
  if (!fs::exists(path, status)) throw Error(ErrorCode::input, path.string() + ": no such file");
  if (!fs::is_regular_file(path, status)) throw Error(ErrorCode::input, path.string() + ": not a regular file");
  std::ifstream in(path, std::ios::binary);
  if (!in) throw Error(ErrorCode::input, path.string() + ": cannot be opened: " + std::strerror(errno));
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(fs::file_size(path, status)));
  in.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  if (static_cast<std::size_t>(in.gcount()) != bytes.size())
    throw Error(ErrorCode::input, path.string() + ": cannot be read to its end");
  return bytes;
}

namespace {

class TemporaryFile {
public:
  explicit TemporaryFile(const fs::path& target)
      : target_(target), name_(target.string() + ".XXXXXX") {
    descriptor_ = ::mkstemp(name_.data());
    if (descriptor_ < 0) fail();
  }
  ~TemporaryFile() {
    if (descriptor_ >= 0) ::close(descriptor_);
    if (!committed_) ::unlink(name_.c_str());
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;

  void write(std::span<const std::uint8_t> bytes) {
    while (!bytes.empty()) {
      const ssize_t written = ::write(descriptor_, bytes.data(), bytes.size());
      if (written < 0 && errno == EINTR) continue;
      if (written < 0) fail();
      bytes = bytes.subspan(static_cast<std::size_t>(written));
    }
  }

  void commit() {
    const mode_t mask = ::umask(0);
    ::umask(mask);
    if (::fchmod(descriptor_, 0666 & ~mask) != 0) fail();
    const int descriptor = descriptor_;
    descriptor_ = -1;
    if (::close(descriptor) != 0) fail();
    if (::rename(name_.c_str(), target_.c_str()) != 0) fail();
    committed_ = true;
  }

private:
  [[noreturn]] void fail() const {
    const std::string reason = std::strerror(errno);
    if (descriptor_ >= 0) ::unlink(name_.c_str());
    throw Error(ErrorCode::output, target_.string() + ": cannot be written: " + reason);
  }

  fs::path target_;
  std::string name_;
  int descriptor_ = -1;
  bool committed_ = false;
};

} // namespace

void write_file(const fs::path& path, std::initializer_list<std::span<const std::uint8_t>> parts) {
  TemporaryFile file(path);
  for (const std::span<const std::uint8_t> part : parts) file.write(part);
  file.commit();
}

void write_file(const fs::path& path, std::span<const std::uint8_t> bytes) {
  write_file(path, std::initializer_list<std::span<const std::uint8_t>>{bytes});
}

void write_file(const fs::path& path, std::string_view text) {
  write_file(path, std::span(reinterpret_cast<const std::uint8_t*>(text.data()), text.size()));
}

void make_folder(const fs::path& path) {
  std::error_code status;
  if (!path.empty()) fs::create_directories(path, status);
  if (status) throw Error(ErrorCode::output, path.string() + ": cannot be made: " + status.message());
}

} // namespace domewarp
