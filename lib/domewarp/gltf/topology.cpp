// SPDX-License-Identifier: Apache-2.0
#include "domewarp/gltf/topology.h"

#include <array>
#include <utility>

#include "domewarp/gltf/document.h"

namespace domewarp::gltf {

namespace {

using Indices = std::vector<std::uint32_t>;

Indices lines_of_strip(const Indices& strip, bool closed) {
  Indices lines;
  for (std::size_t i = 1; i < strip.size(); ++i) lines.insert(lines.end(), {strip[i - 1], strip[i]});
  if (closed) lines.insert(lines.end(), {strip.back(), strip.front()});
  return lines;
}

Indices triangles_of_strip(const Indices& strip) {
  Indices triangles;
  for (std::size_t i = 0; i + 2 < strip.size(); ++i)
    triangles.insert(triangles.end(), {strip[i], strip[i + 1 + i % 2], strip[i + 2 - i % 2]});
  return triangles;
}

Indices triangles_of_fan(const Indices& fan) {
  Indices triangles;
  for (std::size_t i = 0; i + 2 < fan.size(); ++i) triangles.insert(triangles.end(), {fan[i + 1], fan[i + 2], fan[0]});
  return triangles;
}

/// The fewest indices that draw anything, and how many belong together.
constexpr std::array<std::size_t, 7> fewest = {1, 2, 2, 2, 3, 3, 3}, group = {1, 2, 1, 1, 3, 1, 1};

} // namespace

Indices list_indices(int mode, Indices indices, const std::string& place, std::vector<std::string>& warnings) {
  if (mode < 0 || mode > 6) refuse(place, "has the unknown mode " + std::to_string(mode));
  const auto kind = static_cast<std::size_t>(mode);
  const std::size_t whole = indices.size() < fewest[kind] ? 0 : indices.size() / group[kind] * group[kind];
  if (whole < indices.size())
    warnings.push_back(place + ": the last " + std::to_string(indices.size() - whole) + " of " +
                       std::to_string(indices.size()) + " indices are left over in mode " + std::to_string(mode));
  indices.resize(whole);
  if (indices.empty()) return indices;
  switch (mode) {
  case 2:
    return lines_of_strip(indices, true);
  case 3:
    return lines_of_strip(indices, false);
  case 5:
    return triangles_of_strip(indices);
  case 6:
    return triangles_of_fan(indices);
  default:
    return indices;
  }
}

Topology topology_of(int mode) {
  return mode == 0 ? Topology::points : mode < 4 ? Topology::lines : Topology::triangles;
}

void reverse_triangles(Indices& indices, Topology topology) {
  if (topology != Topology::triangles) return;
  for (std::size_t i = 0; i + 2 < indices.size(); i += 3) std::swap(indices[i + 1], indices[i + 2]);
}

} // namespace domewarp::gltf
