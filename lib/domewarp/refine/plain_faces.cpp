// SPDX-License-Identifier: Apache-2.0
#include "domewarp/refine/plain_faces.h"

#include <algorithm>

#include "domewarp/core/parallel.h"
#include "domewarp/refine/warped_vertex.h"

namespace domewarp {

namespace {

class PlainFaces {
public:
  PlainFaces(const Scene& scene, const Soup& soup, const RefineOptions& options) : soup_(soup) {
    for (const SoupPart& part : soup.parts) {
      const Primitive& primitive = scene.meshes[scene.instances[part.instance].mesh].primitives[part.primitive];
      auto& read = read_.emplace_back();
      for (const Attribute& attribute : primitive.attributes)
        if (attribute.name != source_position && (!options.reads || options.reads(primitive.material, attribute.name))) read.push_back(&attribute);
    }
  }

  bool is_plain(const SoupFace& face) const {
    const std::uint32_t first = first_source_of(face.wedge[0]);
    return std::all_of(face.wedge.begin(), face.wedge.end(), [&](std::uint32_t wedge) { return equals(wedge, first, face.part); });
  }

private:
  const Wedge* extra(std::uint32_t wedge) const {
    return wedge < soup_.source_wedges ? nullptr : &soup_.extra_wedges[wedge - soup_.source_wedges];
  }

  std::uint32_t first_source_of(std::uint32_t wedge) const {
    while (const Wedge* blend = extra(wedge)) wedge = blend->parent[0];
    return wedge;
  }

  /// A blend equals what all that it blends equal.
  bool equals(std::uint32_t wedge, std::uint32_t source, std::uint32_t part) const {
    if (const Wedge* blend = extra(wedge)) {
      for (int k = 0; k < 3; ++k)
        if (blend->weight[k] != 0 && !equals(blend->parent[k], source, part)) return false;
      return true;
    }
    const std::size_t p = wedge - soup_.parts[part].first_wedge, q = source - soup_.parts[part].first_wedge;
    return std::all_of(read_[part].begin(), read_[part].end(), [&](const Attribute* attribute) {
      const auto at = [&](std::size_t vertex) { return attribute->values.begin() + static_cast<std::ptrdiff_t>(vertex * attribute->components); };
      return std::equal(at(p), at(p + 1), at(q));
    });
  }

  const Soup& soup_;
  std::vector<std::vector<const Attribute*>> read_; ///< per part
};

} // namespace

std::vector<std::uint8_t> find_plain_faces(const Scene& scene, const Soup& soup, const RefineOptions& options) {
  std::vector<std::uint8_t> plain(soup.faces.size(), 0);
  if (options.vertex_colour) return plain;
  const PlainFaces faces(scene, soup, options);
  parallel_each(plain.size(), 4096, [&](std::size_t f) { plain[f] = faces.is_plain(soup.faces[f]); });
  return plain;
}

} // namespace domewarp
