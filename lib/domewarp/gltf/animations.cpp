// SPDX-License-Identifier: Apache-2.0
#include "domewarp/gltf/animations.h"

#include <cmath>
#include <set>
#include <tuple>

#include "domewarp/core/errors.h"
#include "domewarp/gltf/accessors.h"

namespace domewarp::gltf {

namespace {

bool has_targets(const Document& document, int node) {
  const int mesh = document.nodes[static_cast<std::size_t>(node)].mesh;
  if (mesh < 0) return false;
  for (const PrimitiveSource& primitive : document.meshes[static_cast<std::size_t>(mesh)].primitives)
    if (!primitive.targets.empty()) return true;
  return false;
}

const Accessor& accessor_at(const Document& document, int index) {
  return document.accessors[static_cast<std::size_t>(index)];
}

/// What is wrong with the shape of the data, empty when nothing is.
std::string shape_defect(const Document& document, const AnimationChannel& channel) {
  const Accessor &input = accessor_at(document, channel.input), &output = accessor_at(document, channel.output);
  const int expected = channel.path == "rotation" ? 4 : channel.path == "weights" ? 1 : 3;
  const bool known = channel.path == "rotation" || channel.path == "weights" || channel.path == "translation" ||
                     channel.path == "scale";
  if (known && output.components() != expected)
    return "has values of " + std::to_string(output.components()) + " components for " + channel.path;
  if (input.low.empty() || input.high.empty()) return "has times without min and max";
  for (const Accessor* accessor : {&input, &output})
    if (accessor->view >= 0 && document.views[static_cast<std::size_t>(accessor->view)].stride > 0)
      return "has data in a bufferView with a byteStride";
  return {};
}

bool has_unit_rotations(const Document& document, const AnimationChannel& channel, Budget& budget) {
  const std::vector<float> values = read_floats(document, channel.output, budget);
  const bool cubic = channel.interpolation == Interpolation::cubic;
  const std::size_t step = cubic ? 12 : 4, first = cubic ? 4 : 0;
  for (std::size_t i = first; i + 4 <= values.size(); i += step) {
    const double length = std::hypot(std::hypot(values[i], values[i + 1]), std::hypot(values[i + 2], values[i + 3]));
    if (!(std::abs(length - 1) < 0.005)) return false;
  }
  return true;
}

} // namespace

void check_animations(const Document& document, Budget& budget, std::vector<std::string>& warnings) {
  std::set<std::tuple<std::size_t, int, std::string>> targets;
  for (const AnimationChannel& channel : document.animation_channels) {
    const std::string place = at("animations", channel.animation);
    if (channel.node >= 0 && !targets.insert({channel.animation, channel.node, channel.path}).second)
      warnings.push_back(place + ": moves the " + channel.path + " of node " + std::to_string(channel.node) + " twice");
    if (channel.path == "weights" && channel.node >= 0 && !has_targets(document, channel.node))
      warnings.push_back(place + ": moves the weights of node " + std::to_string(channel.node) +
                         ", which has no morph targets");
    const std::string defect = shape_defect(document, channel);
    if (!defect.empty()) warnings.push_back(place + ": " + defect);
    try {
      if (defect.empty() && channel.path == "rotation" && !has_unit_rotations(document, channel, budget))
        warnings.push_back(place + ": has rotations that are not unit quaternions");
    } catch (const Error& error) {
      warnings.push_back(place + ": " + error.what());
    }
  }
}

} // namespace domewarp::gltf
