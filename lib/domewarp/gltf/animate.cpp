// SPDX-License-Identifier: Apache-2.0
// Based on: glTF 2.0, appendix C, "Animation sampler interpolation modes".
#include "domewarp/gltf/animate.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "domewarp/core/errors.h"
#include "domewarp/gltf/accessors.h"
#include "domewarp/gltf/find_by_name.h"
#include "domewarp/gltf/nodes.h"

namespace domewarp::gltf {

namespace {

using Values = std::vector<double>;

/// Keys and values of one channel, checked to fit each other.
class Curve {
 public:
  Curve(const Document& document, const AnimationChannel& channel, std::size_t width, const std::string& place,
        Budget& budget)
      : interpolation_(channel.interpolation), width_(width), times_(read_floats(document, channel.input, budget)),
        values_(read_floats(document, channel.output, budget)) {
    const std::size_t per_key = interpolation_ == Interpolation::cubic ? 3 : 1;
    if (times_.empty()) refuse(place, "has no keys");
    for (std::size_t i = 0; i < times_.size(); ++i)
      if (!std::isfinite(times_[i]) || (i > 0 && times_[i] <= times_[i - 1]))
        refuse(place, "has times that do not ascend at key " + std::to_string(i));
    if (values_.size() != times_.size() * width * per_key)
      refuse(place, "has " + std::to_string(values_.size()) + " numbers for " + std::to_string(times_.size()) +
                        " keys of " + std::to_string(width * per_key));
    if (!std::all_of(values_.begin(), values_.end(), [](float value) { return std::isfinite(value); }))
      refuse(place, "has a value that is not finite");
  }

  Values at(double time, bool is_rotation) const {
    const std::size_t next = static_cast<std::size_t>(
        std::upper_bound(times_.begin(), times_.end(), time) - times_.begin());
    if (next == 0) return value(0);
    if (next == times_.size() || interpolation_ == Interpolation::step) return value(next - 1);
    const double span = static_cast<double>(times_[next]) - static_cast<double>(times_[next - 1]);
    const double t = (time - static_cast<double>(times_[next - 1])) / span;
    if (interpolation_ == Interpolation::cubic) return hermite(next - 1, t, span);
    return is_rotation ? spherical(value(next - 1), value(next), t) : linear(value(next - 1), value(next), 1 - t, t);
  }

 private:
  /// A triple of a cubic curve: 0 the tangent in, 1 the value, 2 the tangent out.
  Values entry(std::size_t key, std::size_t part) const {
    const bool cubic = interpolation_ == Interpolation::cubic;
    const auto first = values_.begin() + static_cast<std::ptrdiff_t>((cubic ? 3 * key + part : key) * width_);
    return Values(first, first + static_cast<std::ptrdiff_t>(width_));
  }

  Values value(std::size_t key) const { return entry(key, 1); }

  static Values linear(const Values& a, const Values& b, double weight_a, double weight_b) {
    Values result(a.size());
    for (std::size_t i = 0; i < a.size(); ++i) result[i] = a[i] * weight_a + b[i] * weight_b;
    return result;
  }

  /// Along the shorter of the two arcs.
  static Values spherical(const Values& a, const Values& b, double t) {
    double cosine = 0;
    for (std::size_t i = 0; i < a.size(); ++i) cosine += a[i] * b[i];
    const double sign = cosine < 0 ? -1 : 1;
    const double angle = std::acos(std::min(std::abs(cosine), 1.0)), sine = std::sin(angle);
    if (sine < 1e-6) return linear(a, b, 1 - t, sign * t);
    return linear(a, b, std::sin((1 - t) * angle) / sine, sign * std::sin(t * angle) / sine);
  }

  Values hermite(std::size_t key, double t, double span) const {
    const double t2 = t * t, t3 = t2 * t;
    const Values from = linear(value(key), entry(key, 2), 2 * t3 - 3 * t2 + 1, span * (t3 - 2 * t2 + t));
    const Values to = linear(value(key + 1), entry(key + 1, 0), -2 * t3 + 3 * t2, span * (t3 - t2));
    return linear(from, to, 1, 1);
  }

  Interpolation interpolation_;
  std::size_t width_;
  std::vector<float> times_, values_;
};

std::size_t count_targets(const Document& document, const NodeSource& node) {
  std::size_t count = 0;
  if (node.mesh >= 0)
    for (const PrimitiveSource& primitive : document.meshes[static_cast<std::size_t>(node.mesh)].primitives)
      count = std::max(count, primitive.targets.size());
  return count;
}

/// Where a channel's values go, or null with a warning.
Values* find_target(const AnimationChannel& channel, NodeSource& node, const std::string& place,
                    std::vector<std::string>& warnings) {
  if (channel.path == "weights") return &node.weights;
  if (node.has_matrix) {
    warnings.push_back(place + ": moves a node that has a matrix; it stays where it is");
    return nullptr;
  }
  if (channel.path == "translation") return &node.translation;
  if (channel.path == "rotation") return &node.rotation;
  if (channel.path == "scale") return &node.scale;
  warnings.push_back(place + ": moves \"" + channel.path.substr(0, 60) + "\", which is not supported; it stays as it is");
  return nullptr;
}

void apply_channel(const AnimationChannel& channel, double time, const std::string& place, Document& document,
                   Budget& budget, std::vector<std::string>& warnings) {
  NodeSource& node = document.nodes[static_cast<std::size_t>(channel.node)];
  Values* target = find_target(channel, node, place, warnings);
  if (!target) return;
  const std::size_t targets = count_targets(document, node);
  if (channel.path == "weights" && targets == 0) return; // check_animations has named it
  const bool is_rotation = channel.path == "rotation";
  const std::size_t width = is_rotation ? 4 : channel.path == "weights" ? targets : 3;
  *target = Curve(document, channel, width, place, budget).at(time, is_rotation);
  if (channel.path != "weights") node.local = matrix_of(node.translation, node.rotation, node.scale);
}

} // namespace

void apply_animation(const std::string& animation, double time, Document& document, Budget& budget,
                     std::vector<std::string>& warnings) {
  const std::size_t index = find_by_name(animation, document.animations, "--animation", "animation");
  const std::string place = at("animations", index);
  for (const AnimationChannel& channel : document.animation_channels)
    if (channel.animation == index && channel.node >= 0)
      apply_channel(channel, time, place + "." + channel.path.substr(0, 60), document, budget, warnings);
}

} // namespace domewarp::gltf
