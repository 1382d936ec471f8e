// SPDX-License-Identifier: Apache-2.0
#include "domewarp/gltf/primitives.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include <glm/geometric.hpp>

#include "domewarp/gltf/accessors.h"
#include "domewarp/gltf/draco.h"
#include "domewarp/gltf/topology.h"

namespace domewarp::gltf {

namespace {

/// One decoded attribute of the file, whatever its name.
struct Channel {
  std::string name;
  const Accessor* accessor = nullptr;
  int components = 0;
  std::vector<float> values;
};

/// 0 to 31, spelled without leading zeros; more sets are not in use, and each costs the writer an entry per primitive.
bool is_number(std::string_view text) {
  if (text.empty() || text.size() > 2 || text.find_first_not_of("0123456789") != std::string_view::npos) return false;
  return text.size() == 1 || (text[0] != '0' && text <= "31");
}

/// "TEXCOORD_" + digits
bool is_set(std::string_view name, std::string_view prefix) {
  return name.starts_with(prefix) && is_number(name.substr(prefix.size()));
}

bool is_kept(std::string_view name) {
  return name == "NORMAL" || name == "TANGENT" || is_set(name, "TEXCOORD_") || is_set(name, "COLOR_") ||
         name.starts_with("_");
}

bool has_components(std::string_view name, int components) {
  if (name == "POSITION" || name == "NORMAL") return components == 3;
  if (name == "TANGENT" || is_set(name, "JOINTS_") || is_set(name, "WEIGHTS_")) return components == 4;
  if (is_set(name, "TEXCOORD_")) return components == 2;
  if (is_set(name, "COLOR_")) return components == 3 || components == 4;
  return true;
}

class PrimitiveReader {
 public:
  PrimitiveReader(const Document& document, const PrimitiveSource& source, const std::string& place, Budget& budget,
                  std::vector<std::string>& warnings)
      : document_(document), source_(source), place_(place), budget_(budget), warnings_(warnings) {
    if (source.draco_view < 0) return;
    const std::string here = place + ".KHR_draco_mesh_compression";
    if (source.mode != 4 && source.mode != 5) refuse(here, "compresses mode " + std::to_string(source.mode));
    draco_ = decode_draco(view_bytes(document, source.draco_view, here), source.draco_attributes, here, budget);
  }

  PrimitiveParts read() {
    PrimitiveParts parts;
    parts.primitive.material = source_.material;
    parts.primitive.topology = topology_of(source_.mode);
    if (!read_positions(parts.primitive)) {
      warnings_.push_back(place_ + ": has no POSITION and is not drawn");
      return {};
    }
    for (const auto& [name, accessor] : source_.attributes) read_attribute(name, accessor, parts);
    read_influences(parts);
    parts.primitive.indices = list_indices(source_.mode, read_indices(), place_, warnings_);
    return parts;
  }

 private:
  int find(std::string_view name) const {
    for (const auto& [key, accessor] : source_.attributes)
      if (key == name) return accessor;
    return -1;
  }

  const DracoAttribute* find_draco(const std::string& name) const {
    if (!draco_) return nullptr;
    for (const DracoAttribute& attribute : draco_->attributes)
      if (attribute.name == name) return &attribute;
    return nullptr;
  }

  std::vector<float> read_values(const std::string& name, int index) {
    const Accessor& accessor = document_.accessors[static_cast<std::size_t>(index)];
    const std::string here = place_ + "." + name;
    if (!has_components(name, accessor.components()))
      refuse(here, "has " + std::to_string(accessor.components()) + " components");
    const DracoAttribute* draco = find_draco(name);
    if (!draco) return read_floats(document_, index, budget_);
    if (draco->components != accessor.components()) refuse(here, "has other components in Draco than in its accessor");
    budget_.charge(draco->values.size(), sizeof(float), here);
    std::vector<float> values(draco->values.size());
    std::transform(draco->values.begin(), draco->values.end(), values.begin(),
                   [&](double value) { return static_cast<float>(dequantised(value, accessor)); });
    return values;
  }

  bool read_positions(Primitive& primitive) {
    const int index = find("POSITION");
    if (index < 0) return false;
    const Accessor& accessor = document_.accessors[static_cast<std::size_t>(index)];
    const std::string here = place_ + ".POSITION";
    if (accessor.low.empty() || accessor.high.empty()) warnings_.push_back(here + ": has no min and max");
    if (accessor.component_type != 5126 && !document_.quantization_required)
      warnings_.push_back(here + ": has the componentType " + std::to_string(accessor.component_type) +
                          ", but the file does not require KHR_mesh_quantization");
    const std::vector<float> values = read_values("POSITION", index);
    count_ = values.size() / 3;
    if (count_ > UINT32_MAX) refuse(here, "has more than 2^32 vertices");
    budget_.charge(count_, sizeof(Vec3f), here);
    primitive.positions.resize(count_);
    for (std::size_t i = 0; i < count_; ++i) {
      primitive.positions[i] = {values[3 * i], values[3 * i + 1], values[3 * i + 2]};
      if (!std::isfinite(values[3 * i]) || !std::isfinite(values[3 * i + 1]) || !std::isfinite(values[3 * i + 2]))
        refuse(here, "is not finite at vertex " + std::to_string(i));
    }
    return true;
  }

  void warn_of_alignment(const std::string& name, const Accessor& accessor) {
    if (accessor.view < 0) return;
    const std::size_t stride = document_.views[static_cast<std::size_t>(accessor.view)].stride;
    const std::size_t size = static_cast<std::size_t>(accessor.rows) * component_size(accessor.component_type, place_);
    if (accessor.offset % 4 != 0 || (stride ? stride : size) % 4 != 0)
      warnings_.push_back(place_ + "." + name + ": its elements are not aligned to 4 bytes");
  }

  void read_attribute(const std::string& name, int index, PrimitiveParts& parts) {
    const Accessor& accessor = document_.accessors[static_cast<std::size_t>(index)];
    if (!find_draco(name)) warn_of_alignment(name, accessor);
    const bool for_skin = is_set(name, "JOINTS_") || is_set(name, "WEIGHTS_");
    if (name == "POSITION" || for_skin) return;
    if (!is_kept(name)) {
      warnings_.push_back(place_ + ": has the attribute \"" + name.substr(0, 60) +
                          "\", which glTF does not know; it is left out");
      return;
    }
    Attribute attribute{name, accessor.components(), read_values(name, index)};
    check_count(name, attribute.values.size() / static_cast<std::size_t>(attribute.components));
    parts.primitive.attributes.push_back(std::move(attribute));
  }

  void check_count(const std::string& name, std::size_t count) const {
    if (count != count_)
      refuse(place_ + "." + name, "has " + std::to_string(count) + " vertices, POSITION has " + std::to_string(count_));
  }

  void read_influences(PrimitiveParts& parts) {
    for (int set = 0;; ++set) {
      const std::string joints = "JOINTS_" + std::to_string(set), weights = "WEIGHTS_" + std::to_string(set);
      const int joint_accessor = find(joints), weight_accessor = find(weights);
      if (joint_accessor < 0 && weight_accessor < 0) return;
      if (joint_accessor < 0 || weight_accessor < 0) {
        warnings_.push_back(place_ + ": has only one of " + joints + " and " + weights);
        continue;
      }
      Influences influences{read_joints(joints, joint_accessor), read_values(weights, weight_accessor)};
      check_count(joints, influences.joints.size() / 4);
      check_count(weights, influences.weights.size() / 4);
      parts.influences.push_back(std::move(influences));
    }
  }

  std::vector<std::uint32_t> read_joints(const std::string& name, int index) {
    const DracoAttribute* draco = find_draco(name);
    if (!draco) {
      if (!has_components(name, document_.accessors[static_cast<std::size_t>(index)].components()))
        refuse(place_ + "." + name, "has not 4 components");
      return read_naturals(document_, index, budget_);
    }
    std::vector<std::uint32_t> joints;
    joints.reserve(draco->values.size());
    for (const double value : draco->values)
      joints.push_back(static_cast<std::uint32_t>(std::clamp(value, 0.0, 4294967295.0)));
    return joints;
  }

  std::vector<std::uint32_t> read_indices() {
    if (draco_) return std::move(draco_->indices);
    std::vector<std::uint32_t> indices;
    if (source_.indices < 0) {
      budget_.charge(count_, sizeof(std::uint32_t), place_);
      indices.resize(count_);
      std::iota(indices.begin(), indices.end(), 0u);
      return indices;
    }
    const Accessor& accessor = document_.accessors[static_cast<std::size_t>(source_.indices)];
    if (accessor.components() != 1) refuse(place_ + ".indices", "are no scalars");
    indices = read_naturals(document_, source_.indices, budget_);
    check_indices(indices, component_size(accessor.component_type, place_));
    // Strips and fans become lists of up to three times the size.
    budget_.charge(indices.size(), 3 * sizeof(std::uint32_t), place_);
    return indices;
  }

  void check_indices(const std::vector<std::uint32_t>& indices, std::size_t size) const {
    const std::uint32_t restart = size == 4 ? 0xFFFFFFFFu : size == 2 ? 0xFFFFu : 0xFFu;
    if (indices.empty() || *std::max_element(indices.begin(), indices.end()) < std::min<std::size_t>(count_, restart)) return;
    for (std::size_t i = 0; i < indices.size(); ++i) {
      if (indices[i] == restart)
        refuse(place_ + ".indices", "restart a primitive at " + std::to_string(i) + ", which glTF does not allow");
      if (indices[i] >= count_)
        refuse(place_ + ".indices", "refer at " + std::to_string(i) + " to vertex " + std::to_string(indices[i]) +
                                        " of " + std::to_string(count_));
    }
  }

  const Document& document_;
  const PrimitiveSource& source_;
  const std::string& place_;
  Budget& budget_;
  std::vector<std::string>& warnings_;
  std::optional<DracoMesh> draco_;
  std::size_t count_ = 0;
};

} // namespace

PrimitiveParts read_primitive(const Document& document, const PrimitiveSource& source, const std::string& place,
                              Budget& budget, std::vector<std::string>& warnings) {
  return PrimitiveReader(document, source, place, budget, warnings).read();
}

} // namespace domewarp::gltf
