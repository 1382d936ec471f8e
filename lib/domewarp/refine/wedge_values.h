// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "domewarp/refine/refine.h"
#include "domewarp/refine/refined_mesh.h"

namespace domewarp {

/// The attributes of the written vertices. Those of derived wedges are computed once, in the space of their mesh,
/// components of all attributes of the part side by side.
class WedgeValues {
public:
  /// @param drawn per wedge: whether a written face uses it
  WedgeValues(const Scene& scene, const Soup& soup, const RefinedMesh& refined, const std::vector<std::uint8_t>& drawn,
              const RefineOptions& options);

  const Primitive& primitive(std::uint32_t part) const;

  /// The attributes of a part that are written.
  const std::vector<const Attribute*>& written(std::uint32_t part) const { return written_[part]; }

  /// Components `first` to `first` + `count` of a derived wedge that is drawn, of all that are written.
  const double* derived(std::uint32_t wedge, int first) const { return &values_[offset_[wedge - first_derived_] + first]; }

  bool is_derived(std::uint32_t wedge) const { return wedge >= first_derived_; }
  std::uint32_t point_of(std::uint32_t wedge) const { return wedge < soup_.wedge_point.size() ? soup_.wedge_point[wedge] : wedge_of(wedge).point; }

  /// Derived wedges that are drawn, by part, ascending.
  const std::vector<std::uint32_t>& derived_of(std::uint32_t part) const { return derived_of_[part]; }

private:
  const Wedge& wedge_of(std::uint32_t wedge) const;
  void find_needed(const std::vector<std::uint8_t>& drawn, std::vector<std::uint8_t>& needed);
  void blend(std::uint32_t wedge);

  const Scene& scene_;
  const Soup& soup_;
  const RefinedMesh& refined_;
  std::uint32_t first_derived_;
  std::vector<std::vector<const Attribute*>> written_; ///< per part
  std::vector<int> stride_;          ///< per part
  std::vector<std::vector<std::uint32_t>> derived_of_; ///< per part
  std::vector<std::size_t> offset_;  ///< per derived wedge
  std::vector<double> values_;
};

} // namespace domewarp
