// SPDX-License-Identifier: Apache-2.0
// libFuzzer target: whatever the bytes, read_scene gives a scene or throws Error, within its memory limit; and what it
// gives can be written.
#include <cstddef>
#include <cstdint>
#include <string>

#include <sys/mman.h>
#include <unistd.h>

#include "domewarp/core/errors.h"
#include "domewarp/gltf/read.h"
#include "domewarp/gltf/write.h"

namespace {

/// A file in memory under a path of its own; thousands of real files a second would wear the disk.
class MemoryFile {
 public:
  MemoryFile(const std::uint8_t* data, std::size_t size) : descriptor_(::memfd_create("fuzz", 0)) {
    if (::write(descriptor_, data, size) != static_cast<ssize_t>(size)) ::abort();
  }
  ~MemoryFile() { ::close(descriptor_); }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;
  std::string path() const { return "/proc/self/fd/" + std::to_string(descriptor_); }

 private:
  int descriptor_;
};

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const MemoryFile file(data, size);
  try {
    const domewarp::Scene scene = domewarp::read_scene(file.path(), {.max_bytes = std::size_t(1) << 26});
    domewarp::encode_glb(scene);
    domewarp::encode_glb(scene, {.draco = true});
    domewarp::encode_glb(scene, {.quantize = true});
    domewarp::encode_glb(scene, {.meshopt = true});
  } catch (const domewarp::Error&) {
  }
  return 0;
}
