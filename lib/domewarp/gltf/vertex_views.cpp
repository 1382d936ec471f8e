// SPDX-License-Identifier: Apache-2.0
#include "domewarp/gltf/vertex_views.h"

#include <map>
#include <set>

namespace domewarp::gltf {

namespace {

using Users = std::map<int, std::set<int>>; ///< the vertex accessors of each view

void add_users(const Document& document, const AttributeMap& attributes, Users& users) {
  for (const auto& [name, accessor] : attributes) {
    const int view = document.accessors[static_cast<std::size_t>(accessor)].view;
    if (view >= 0) users[view].insert(accessor);
  }
}

} // namespace

void check_vertex_views(const Document& document, std::vector<std::string>& warnings) {
  Users users;
  for (const MeshSource& mesh : document.meshes)
    for (const PrimitiveSource& primitive : mesh.primitives) {
      add_users(document, primitive.attributes, users);
      for (const AttributeMap& target : primitive.targets) add_users(document, target, users);
    }
  for (const auto& [view, accessors] : users)
    if (accessors.size() > 1 && document.views[static_cast<std::size_t>(view)].stride == 0)
      warnings.push_back(at("bufferViews", static_cast<std::size_t>(view)) + ": is shared by " +
                         std::to_string(accessors.size()) + " vertex accessors without a byteStride");
}

} // namespace domewarp::gltf
