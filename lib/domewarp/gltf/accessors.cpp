// SPDX-License-Identifier: Apache-2.0
#include "domewarp/gltf/accessors.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "domewarp/core/errors.h"

namespace domewarp::gltf {

namespace {

constexpr int int8_type = 5120, uint8_type = 5121, int16_type = 5122, uint16_type = 5123, uint32_type = 5125,
              float_type = 5126;

/// Where elements stand in a view that has been checked to hold them all.
struct Elements {
  const std::uint8_t* data = nullptr; ///< null: zeros
  std::size_t stride = 0;
};

/// Columns of matrices of small components start at multiples of four bytes.
std::size_t column_stride(const Accessor& accessor, std::size_t size) {
  const std::size_t bytes = static_cast<std::size_t>(accessor.rows) * size;
  return accessor.columns > 1 ? (bytes + 3) / 4 * 4 : bytes;
}

Elements find_elements(const Document& document, int view, std::size_t offset, std::size_t count, std::size_t size,
                       bool strided, const std::string& place) {
  const std::span<const std::uint8_t> bytes = view_bytes(document, view, place);
  const std::size_t declared = strided ? document.views[static_cast<std::size_t>(view)].stride : 0;
  const std::size_t stride = declared ? declared : size;
  if (stride < size)
    refuse(place, "has elements of " + std::to_string(size) + " bytes in a byteStride of " + std::to_string(stride));
  if (offset > bytes.size() || bytes.size() - offset < size ||
      (count > 0 && (bytes.size() - offset - size) / stride < count - 1))
    refuse(place, "needs " + std::to_string(count) + " elements of " + std::to_string(stride) + " bytes from byte " +
                      std::to_string(offset) + ", but its bufferView has " + std::to_string(bytes.size()) + " bytes");
  return {bytes.data() + offset, stride};
}

std::size_t element_size(const Accessor& accessor, std::size_t size) {
  return column_stride(accessor, size) * static_cast<std::size_t>(accessor.columns);
}

template <typename T>
double load(const std::uint8_t* data) {
  T value;
  std::memcpy(&value, data, sizeof(T));
  return static_cast<double>(value);
}


template <typename T, typename Store>
void each_component_as(const Accessor& accessor, const Elements& elements, std::size_t count, Store&& store) {
  const std::size_t column = column_stride(accessor, sizeof(T));
  const auto rows = static_cast<std::size_t>(accessor.rows), columns = static_cast<std::size_t>(accessor.columns);
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t c = 0; c < columns; ++c)
      for (std::size_t r = 0; r < rows; ++r)
        store(i, c * rows + r, load<T>(elements.data + i * elements.stride + c * column + r * sizeof(T)));
}

/// Calls store(element, component, raw value) for `count` elements.
template <typename Store>
void each_component(const Accessor& accessor, const Elements& elements, std::size_t count, Store&& store) {
  switch (accessor.component_type) {
  case int8_type:
    return each_component_as<std::int8_t>(accessor, elements, count, store);
  case uint8_type:
    return each_component_as<std::uint8_t>(accessor, elements, count, store);
  case int16_type:
    return each_component_as<std::int16_t>(accessor, elements, count, store);
  case uint16_type:
    return each_component_as<std::uint16_t>(accessor, elements, count, store);
  case uint32_type:
    return each_component_as<std::uint32_t>(accessor, elements, count, store);
  default:
    return each_component_as<float>(accessor, elements, count, store);
  }
}

std::vector<std::size_t> sparse_targets(const Document& document, const Accessor& accessor, const std::string& place,
                                        Budget& budget) {
  const Sparse& sparse = accessor.sparse;
  if (sparse.count == 0 || sparse.count > accessor.count)
    refuse(place, "replaces " + std::to_string(sparse.count) + " of " + std::to_string(accessor.count) + " elements");
  if (sparse.index_type != uint8_type && sparse.index_type != uint16_type && sparse.index_type != uint32_type)
    refuse(place, "has indices of the type " + std::to_string(sparse.index_type));
  const std::size_t size = component_size(sparse.index_type, place);
  const Elements elements =
      find_elements(document, sparse.index_view, sparse.index_offset, sparse.count, size, false, place);
  budget.charge(sparse.count, sizeof(std::size_t), place);
  std::vector<std::size_t> targets(sparse.count);
  Accessor indices;
  indices.component_type = sparse.index_type;
  each_component(indices, elements, sparse.count,
                 [&](std::size_t i, std::size_t, double value) { targets[i] = static_cast<std::size_t>(value); });
  for (const std::size_t target : targets)
    if (target >= accessor.count)
      refuse(place, "has the index " + std::to_string(target) + " of " + std::to_string(accessor.count) + " elements");
  return targets;
}

bool is_sparse(const Accessor& accessor) {
  return accessor.sparse.index_view >= 0;
}

/// Calls store(element, component, raw value) for everything that is not zero by default.
template <typename Store>
void each_value(const Document& document, const Accessor& accessor, const std::string& place, Budget& budget,
                Store&& store) {
  const std::size_t size = component_size(accessor.component_type, place);
  const std::size_t element = element_size(accessor, size);
  if (accessor.view >= 0 && accessor.count > 0)
    each_component(accessor,
                   find_elements(document, accessor.view, accessor.offset, accessor.count, element, true, place),
                   accessor.count, store);
  if (!is_sparse(accessor)) return;
  const std::string here = place + ".sparse";
  const std::vector<std::size_t> targets = sparse_targets(document, accessor, here, budget);
  const Elements values = find_elements(document, accessor.sparse.value_view, accessor.sparse.value_offset,
                                        targets.size(), element, false, here);
  each_component(accessor, values, targets.size(),
                 [&](std::size_t i, std::size_t c, double value) { store(targets[i], c, value); });
}

/// Copies elements whose bytes need no conversion. @return whether they are such, of components of `type`
template <typename T>
bool copy_elements(const Document& document, const Accessor& accessor, int type, const std::string& place, std::vector<T>& values) {
  if (accessor.component_type != type || accessor.view < 0 || accessor.count == 0 || is_sparse(accessor)) return false;
  const std::size_t size = element_size(accessor, sizeof(T));
  const Elements elements = find_elements(document, accessor.view, accessor.offset, accessor.count, size, true, place);
  auto* out = reinterpret_cast<std::uint8_t*>(values.data());
  if (elements.stride == size)
    std::memcpy(out, elements.data, accessor.count * size);
  else
    for (std::size_t i = 0; i < accessor.count; ++i) std::memcpy(out + i * size, elements.data + i * elements.stride, size);
  return true;
}

/// Data bound the count of an accessor that has some. One of zeros is bounded here, as text alone could ask for
/// terabytes.
void check_count(const Accessor& accessor, const std::string& place) {
  constexpr std::size_t most_zeros = std::size_t(1) << 26;
  if (accessor.view < 0 && accessor.count > most_zeros)
    refuse(place, "has " + std::to_string(accessor.count) + " elements without data");
}

} // namespace

std::size_t component_size(int type, const std::string& place) {
  switch (type) {
  case int8_type:
  case uint8_type:
    return 1;
  case int16_type:
  case uint16_type:
    return 2;
  case uint32_type:
  case float_type:
    return 4;
  default:
    refuse(place, "has the unknown componentType " + std::to_string(type));
  }
}

double dequantised(double value, const Accessor& accessor) {
  if (!accessor.normalized) return value;
  switch (accessor.component_type) {
  case int8_type:
    return std::max(value / 127, -1.0);
  case uint8_type:
    return value / 255;
  case int16_type:
    return std::max(value / 32767, -1.0);
  case uint16_type:
    return value / 65535;
  case uint32_type:
    return value / 4294967295.0;
  default:
    return value;
  }
}

std::vector<float> read_floats(const Document& document, int index, Budget& budget) {
  const Accessor& accessor = document.accessors[static_cast<std::size_t>(index)];
  const std::string place = at("accessors", static_cast<std::size_t>(index));
  const auto components = static_cast<std::size_t>(accessor.components());
  check_count(accessor, place);
  budget.charge(accessor.count, components * sizeof(float), place);
  // Fail on the range before the memory is asked for.
  if (accessor.view >= 0 && accessor.count > view_bytes(document, accessor.view, place).size())
    refuse(place, "has " + std::to_string(accessor.count) + " elements, more than its bufferView has bytes");
  std::vector<float> values(accessor.count * components);
  if (copy_elements(document, accessor, float_type, place, values)) return values;
  each_value(document, accessor, place, budget, [&](std::size_t i, std::size_t c, double value) {
    values[i * components + c] = static_cast<float>(dequantised(value, accessor));
  });
  return values;
}

std::vector<std::uint32_t> read_naturals(const Document& document, int index, Budget& budget) {
  const Accessor& accessor = document.accessors[static_cast<std::size_t>(index)];
  const std::string place = at("accessors", static_cast<std::size_t>(index));
  const int type = accessor.component_type;
  if (type != uint8_type && type != uint16_type && type != uint32_type)
    refuse(place, "holds indices of the componentType " + std::to_string(type));
  const auto components = static_cast<std::size_t>(accessor.components());
  check_count(accessor, place);
  if (accessor.view >= 0 && accessor.count > view_bytes(document, accessor.view, place).size())
    refuse(place, "has " + std::to_string(accessor.count) + " elements, more than its bufferView has bytes");
  budget.charge(accessor.count, components * sizeof(std::uint32_t), place);
  std::vector<std::uint32_t> values(accessor.count * components);
  if (copy_elements(document, accessor, uint32_type, place, values)) return values;
  each_value(document, accessor, place, budget, [&](std::size_t i, std::size_t c, double value) {
    values[i * components + c] = static_cast<std::uint32_t>(value);
  });
  return values;
}

namespace {

struct Bounds {
  std::vector<double> low, high;
};

Bounds true_bounds(const Document& document, const Accessor& accessor, const std::string& place, Budget& budget) {
  const auto components = static_cast<std::size_t>(accessor.components());
  const bool has_zeros = accessor.view < 0;
  Bounds bounds{std::vector<double>(components, has_zeros ? 0 : std::numeric_limits<double>::infinity()),
                std::vector<double>(components, has_zeros ? 0 : -std::numeric_limits<double>::infinity())};
  if (is_sparse(accessor)) {
    // Replaced elements must not count, so the final values are needed.
    Accessor raw = accessor;
    raw.normalized = false;
    std::vector<double> values(accessor.count * components);
    each_value(document, raw, place, budget,
               [&](std::size_t i, std::size_t c, double value) { values[i * components + c] = value; });
    std::fill(bounds.low.begin(), bounds.low.end(), std::numeric_limits<double>::infinity());
    std::fill(bounds.high.begin(), bounds.high.end(), -std::numeric_limits<double>::infinity());
    for (std::size_t i = 0; i < values.size(); ++i) {
      bounds.low[i % components] = std::min(bounds.low[i % components], values[i]);
      bounds.high[i % components] = std::max(bounds.high[i % components], values[i]);
    }
    return bounds;
  }
  each_value(document, accessor, place, budget, [&](std::size_t, std::size_t c, double value) {
    bounds.low[c] = std::min(bounds.low[c], value);
    bounds.high[c] = std::max(bounds.high[c], value);
  });
  return bounds;
}

/// Bounds are written as decimal text, often of the float32 value with too few digits.
bool agrees(double declared, double found, const Accessor& accessor) {
  if (accessor.component_type != float_type) return declared == found;
  return std::abs(declared - found) <= 1e-6 * std::max(std::abs(found), 1e-30) ||
         static_cast<float>(declared) == static_cast<float>(found);
}

void compare(const std::vector<double>& declared, const std::vector<double>& found, const Accessor& accessor,
             const std::string& place, std::vector<std::string>& warnings) {
  if (declared.empty()) return;
  if (declared.size() != found.size()) {
    warnings.push_back(place + ": has " + std::to_string(declared.size()) + " numbers for " +
                       std::to_string(found.size()) + " components");
    return;
  }
  for (std::size_t i = 0; i < found.size(); ++i)
    if (!agrees(declared[i], found[i], accessor)) {
      warnings.push_back(place + ": is " + std::to_string(declared[i]) + " where the data say " +
                         std::to_string(found[i]));
      return;
    }
}

} // namespace

namespace {

void check_accessor(const Document& document, const Accessor& accessor, const std::string& place, Budget& budget,
                    std::vector<std::string>& warnings) {
  const std::size_t size = component_size(accessor.component_type, place);
  if (accessor.count == 0) warnings.push_back(place + ": has count 0");
  if (accessor.count == 0 || (accessor.view < 0 && !is_sparse(accessor))) return;
  check_count(accessor, place);
  const std::size_t stride = accessor.view < 0 ? 0 : document.views[static_cast<std::size_t>(accessor.view)].stride;
  if (stride > 0 && stride < element_size(accessor, size))
    refuse(place, "has elements larger than the byteStride " + std::to_string(stride));
  if (accessor.view >= 0 &&
      (accessor.offset + document.views[static_cast<std::size_t>(accessor.view)].offset) % size != 0)
    warnings.push_back(place + ": is not aligned to its components");
  if (accessor.low.empty() && accessor.high.empty() && !is_sparse(accessor)) {
    find_elements(document, accessor.view, accessor.offset, accessor.count, element_size(accessor, size), true, place);
    return;
  }
  if (is_sparse(accessor))
    budget.charge(accessor.count, sizeof(double) * static_cast<std::size_t>(accessor.components()), place);
  const Bounds bounds = true_bounds(document, accessor, place, budget);
  compare(accessor.low, bounds.low, accessor, place + ".min", warnings);
  compare(accessor.high, bounds.high, accessor, place + ".max", warnings);
}

} // namespace

void check_accessors(const Document& document, Budget& budget, std::vector<std::string>& warnings) {
  // Many accessors may lie over the same bytes; a hostile file could make this pass take hours.
  constexpr std::size_t most_components = std::size_t(1) << 30;
  std::size_t components = 0;
  for (std::size_t i = 0; i < document.accessors.size() && components < most_components; ++i) {
    const Accessor& accessor = document.accessors[i];
    components += accessor.count * static_cast<std::size_t>(accessor.components());
    try {
      check_accessor(document, accessor, at("accessors", i), budget, warnings);
    } catch (const Error& error) {
      warnings.push_back(error.what());
    }
  }
}

} // namespace domewarp::gltf
