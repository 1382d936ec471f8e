// SPDX-License-Identifier: Apache-2.0
#include "domewarp/refine/wedge_values.h"

#include <algorithm>

#include "domewarp/core/parallel.h"
#include "domewarp/refine/warped_vertex.h"

namespace domewarp {

WedgeValues::WedgeValues(const Scene& scene, const Soup& soup, const RefinedMesh& refined, const std::vector<std::uint8_t>& drawn,
                         const RefineOptions& options)
    : scene_(scene), soup_(soup), refined_(refined), first_derived_(static_cast<std::uint32_t>(soup.source_wedges)), derived_of_(soup.parts.size()) {
  for (std::uint32_t part = 0; part < soup.parts.size(); ++part) {
    written_.push_back(written_attributes(primitive(part), options));
    int stride = 0;
    for (const Attribute* attribute : written_.back()) stride += attribute->components;
    stride_.push_back(stride);
  }
  const std::size_t count = drawn.size() - first_derived_;
  std::vector<std::uint8_t> needed;
  find_needed(drawn, needed);
  offset_.resize(count);
  std::size_t size = 0;
  for (std::uint32_t i = 0; i < count; ++i) {
    offset_[i] = size;
    if (needed[i]) size += stride_[wedge_of(first_derived_ + i).part];
    if (drawn[first_derived_ + i]) derived_of_[wedge_of(first_derived_ + i).part].push_back(first_derived_ + i);
  }
  values_.resize(size);
  if (size == 0) return;
  std::size_t done = 0;
  const auto blend_to = [&](std::size_t end, std::size_t grain) {
    parallel_each(end - done, grain, [&, done](std::size_t i) {
      if (needed[done + i]) blend(static_cast<std::uint32_t>(first_derived_ + done + i));
    });
    done = end;
  };
  blend_to(soup.extra_wedges.size(), soup.extra_wedges.size());
  for (const std::size_t end : refined.wedge_groups) blend_to(soup.extra_wedges.size() + end, 256);
  blend_to(count, count);
}

const Primitive& WedgeValues::primitive(std::uint32_t part) const {
  return scene_.meshes[scene_.instances[soup_.parts[part].instance].mesh].primitives[soup_.parts[part].primitive];
}

const Wedge& WedgeValues::wedge_of(std::uint32_t wedge) const {
  const std::uint32_t i = wedge - first_derived_;
  return i < soup_.extra_wedges.size() ? soup_.extra_wedges[i] : refined_.wedges[i - soup_.extra_wedges.size()];
}

/// A wedge's parents come before it, so one descending pass finds what is drawn and what that is made of.
void WedgeValues::find_needed(const std::vector<std::uint8_t>& drawn, std::vector<std::uint8_t>& needed) {
  needed.assign(drawn.begin() + first_derived_, drawn.end());
  for (std::size_t i = needed.size(); i-- > 0;)
    if (needed[i])
      for (const std::uint32_t parent : wedge_of(static_cast<std::uint32_t>(first_derived_ + i)).parent)
        if (parent >= first_derived_) needed[parent - first_derived_] = 1;
}

void WedgeValues::blend(std::uint32_t id) {
  const Wedge& wedge = wedge_of(id);
  double* out = values_.data() + offset_[id - first_derived_];
  for (int k = 0; k < 3; ++k) {
    if (wedge.weight[k] == 0) continue;
    const std::uint32_t parent = wedge.parent[k];
    if (is_derived(parent)) {
      const double* in = derived(parent, 0);
      for (int c = 0; c < stride_[wedge.part]; ++c) out[c] += wedge.weight[k] * in[c];
      continue;
    }
    const std::size_t vertex = parent - soup_.parts[wedge.part].first_wedge;
    double* to = out;
    for (const Attribute* attribute : written_[wedge.part])
      for (int c = 0; c < attribute->components; ++c) *to++ += wedge.weight[k] * static_cast<double>(attribute->values[vertex * attribute->components + c]);
  }
}

} // namespace domewarp
