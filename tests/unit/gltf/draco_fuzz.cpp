// SPDX-License-Identifier: Apache-2.0
// libFuzzer target: whatever the bytes of a Draco stream, it is decoded within the memory limit or refused.
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "domewarp/core/errors.h"
#include "domewarp/gltf/draco.h"

namespace {

/// Random bytes hardly ever have a good head; a bit of the first byte says whether to put one before them. The others
/// choose the method: 0 sequential, 1 edgebreaker.
std::vector<std::uint8_t> stream_of(const std::uint8_t* data, std::size_t size) {
  std::vector<std::uint8_t> stream;
  if (size > 0 && (data[0] & 1)) stream = {'D', 'R', 'A', 'C', 'O', 2, 2, 1, static_cast<std::uint8_t>((data[0] >> 1) & 1), 0, 0};
  if (size > 0) stream.insert(stream.end(), data + 1, data + size);
  return stream;
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  domewarp::gltf::Budget budget(std::size_t(1) << 26);
  try {
    domewarp::gltf::decode_draco(stream_of(data, size), {{"POSITION", 0}, {"NORMAL", 1}}, "stream", budget);
  } catch (const domewarp::Error&) {
  }
  return 0;
}
