// SPDX-License-Identifier: Apache-2.0
#include "domewarp/gltf/meshopt_encode.h"

#include <algorithm>

#include <meshoptimizer.h>

#include "domewarp/core/errors.h"

namespace domewarp::gltf {

namespace {

/// The versions of the streams that the extension prescribes. meshoptimizer keeps them for the whole process.
void choose_versions() {
  [[maybe_unused]] static const bool once = [] {
    meshopt_encodeVertexVersion(0);
    meshopt_encodeIndexVersion(1);
    return true;
  }();
}

void finish(MeshoptStream& stream, std::size_t size) {
  if (size == 0) throw Error(ErrorCode::output, "meshoptimizer cannot compress a primitive");
  stream.bytes.resize(size);
}

} // namespace

MeshoptStream encode_vertices(std::span<const std::uint8_t> vertices, std::size_t count, std::size_t stride) {
  choose_versions();
  MeshoptStream stream{std::vector<std::uint8_t>(meshopt_encodeVertexBufferBound(count, stride)), "ATTRIBUTES", count, stride};
  finish(stream, meshopt_encodeVertexBuffer(stream.bytes.data(), stream.bytes.size(), vertices.data(), count, stride));
  return stream;
}

MeshoptStream encode_indices(const std::vector<std::uint32_t>& indices, bool are_triangles, std::size_t stride) {
  choose_versions();
  const std::size_t count = indices.size();
  const std::size_t vertices = std::size_t(*std::max_element(indices.begin(), indices.end())) + 1;
  MeshoptStream stream{{}, are_triangles ? "TRIANGLES" : "INDICES", count, stride};
  stream.bytes.resize(are_triangles ? meshopt_encodeIndexBufferBound(count, vertices) : meshopt_encodeIndexSequenceBound(count, vertices));
  finish(stream, are_triangles ? meshopt_encodeIndexBuffer(stream.bytes.data(), stream.bytes.size(), indices.data(), count)
                               : meshopt_encodeIndexSequence(stream.bytes.data(), stream.bytes.size(), indices.data(), count));
  return stream;
}

} // namespace domewarp::gltf
