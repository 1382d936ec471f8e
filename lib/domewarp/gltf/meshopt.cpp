// SPDX-License-Identifier: Apache-2.0
#include "domewarp/gltf/meshopt.h"

#include <meshoptimizer.h>

namespace domewarp::gltf {

namespace {

/// The densest stream codes 16 vertices' bytes in 2 bits, or a triangle in a byte; more is a lie about the count.
constexpr std::size_t densest = 64;

void check_shape(const MeshoptSource& source, const std::string& place) {
  const bool vertices = source.mode == "ATTRIBUTES";
  if (!vertices && source.mode != "TRIANGLES" && source.mode != "INDICES")
    refuse(place, "has the unknown mode \"" + source.mode + "\"");
  const bool good_stride = vertices ? source.stride > 0 && source.stride <= 256 && source.stride % 4 == 0
                                    : source.stride == 2 || source.stride == 4;
  if (!good_stride)
    refuse(place, "has byteStride " + std::to_string(source.stride) + ", which mode " + source.mode + " cannot have");
  if (source.mode == "TRIANGLES" && source.count % 3 != 0)
    refuse(place, "has " + std::to_string(source.count) + " indices, not whole triangles");
  if (source.count == 0 || source.count / densest > source.length + 64 ||
      source.count * source.stride / densest > source.length + 64)
    refuse(place,
           "cannot hold " + std::to_string(source.count) + " elements in " + std::to_string(source.length) + " bytes");
}

void apply_filter(const MeshoptSource& source, std::vector<std::uint8_t>& bytes, const std::string& place) {
  if (source.filter == "NONE") return;
  if (source.mode != "ATTRIBUTES") refuse(place, "has a filter on indices");
  if (source.filter == "OCTAHEDRAL" && (source.stride == 4 || source.stride == 8))
    meshopt_decodeFilterOct(bytes.data(), source.count, source.stride);
  else if (source.filter == "QUATERNION" && source.stride == 8)
    meshopt_decodeFilterQuat(bytes.data(), source.count, source.stride);
  else if (source.filter == "EXPONENTIAL")
    meshopt_decodeFilterExp(bytes.data(), source.count, source.stride);
  else
    refuse(place, "has the filter \"" + source.filter + "\" with byteStride " + std::to_string(source.stride) +
                      ", which is not supported");
}

std::vector<std::uint8_t> decode(const MeshoptSource& source, std::span<const std::uint8_t> stream,
                                 const std::string& place) {
  std::vector<std::uint8_t> bytes(source.count * source.stride);
  int status = 0;
  if (source.mode == "ATTRIBUTES")
    status = meshopt_decodeVertexBuffer(bytes.data(), source.count, source.stride, stream.data(), stream.size());
  else if (source.mode == "TRIANGLES")
    status = meshopt_decodeIndexBuffer(bytes.data(), source.count, source.stride, stream.data(), stream.size());
  else
    status = meshopt_decodeIndexSequence(bytes.data(), source.count, source.stride, stream.data(), stream.size());
  if (status != 0) refuse(place, "is not a valid meshopt stream (code " + std::to_string(status) + ")");
  apply_filter(source, bytes, place);
  return bytes;
}

} // namespace

void decode_meshopt(Document& document, Budget& budget) {
  for (std::size_t i = 0; i < document.views.size(); ++i) {
    View& view = document.views[i];
    const MeshoptSource& source = view.meshopt;
    if (source.buffer < 0) continue;
    const std::string place = at("bufferViews", i) + ".meshopt_compression";
    check_shape(source, place);
    budget.charge(source.count, source.stride, place);
    const std::vector<std::uint8_t>& buffer = document.buffers[static_cast<std::size_t>(source.buffer)];
    std::vector<std::uint8_t> bytes = decode(source, std::span(buffer).subspan(source.offset, source.length), place);
    view.length = bytes.size();
    view.offset = 0;
    view.stride = source.mode == "ATTRIBUTES" ? source.stride : 0;
    view.buffer = static_cast<int>(document.buffers.size());
    document.buffers.push_back(std::move(bytes));
  }
}

} // namespace domewarp::gltf
