// SPDX-License-Identifier: Apache-2.0
#include "domewarp/core/files.h"

#include <cerrno>
#include <cstring>
#include <fstream>
#include <system_error>

#include <fcntl.h>
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

[[noreturn]] void fail_to_write(const fs::path& path) {
  throw Error(ErrorCode::output, path.string() + ": cannot be written: " + std::strerror(errno));
}

using Parts = std::initializer_list<std::span<const std::uint8_t>>;

/// False when something went wrong; errno says what.
bool write_all(int descriptor, const Parts& parts) {
  for (std::span<const std::uint8_t> bytes : parts)
    while (!bytes.empty()) {
      const ssize_t written = ::write(descriptor, bytes.data(), bytes.size());
      if (written < 0 && errno == EINTR) continue;
      if (written < 0) return false;
      bytes = bytes.subspan(static_cast<std::size_t>(written));
    }
  return true;
}

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

  void write(const Parts& parts) {
    if (!write_all(descriptor_, parts)) fail();
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
    const int reason = errno;
    if (descriptor_ >= 0) ::unlink(name_.c_str());
    errno = reason;
    fail_to_write(target_);
  }

  fs::path target_;
  std::string name_;
  int descriptor_ = -1;
  bool committed_ = false;
};

/// Into what is there already and is no file.
void write_device(const fs::path& path, const Parts& parts) {
  const int descriptor = ::open(path.c_str(), O_WRONLY | O_CLOEXEC);
  if (descriptor < 0) fail_to_write(path);
  const bool written = write_all(descriptor, parts);
  const int reason = errno;
  ::close(descriptor);
  errno = reason;
  if (!written) fail_to_write(path);
}

} // namespace

bool is_same_file(const fs::path& a, const fs::path& b) {
  std::error_code status;
  return fs::equivalent(a, b, status);
}

void write_file(const fs::path& path, std::initializer_list<std::span<const std::uint8_t>> parts) {
  std::error_code status;
  if (fs::is_other(path, status)) return write_device(path, parts);
  TemporaryFile file(fs::is_symlink(path, status) ? fs::weakly_canonical(path, status) : path);
  file.write(parts);
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
