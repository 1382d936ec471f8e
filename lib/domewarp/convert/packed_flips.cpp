// SPDX-License-Identifier: Apache-2.0
#include "domewarp/convert/packed_flips.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <map>
#include <tuple>

#include <glm/geometric.hpp>

#include "domewarp/core/parallel.h"

namespace domewarp {

namespace {

constexpr double turned_px = 5e-4;   ///< half of what the audit calls turned
constexpr double edge_on = 0x1p-19;  ///< relative: single precision of the source does not tell how what is thinner for the eye turns
constexpr int reach = 3;             ///< steps of the grid
constexpr int most_rounds = 16;

using Key = std::tuple<float, float, float>;
Key key_of(const Vec3f& p) { return {p.x + 0.0f, p.y + 0.0f, p.z + 0.0f}; }

struct Shown {
  double twice_area = 0, longest = 0; ///< image units
};

class Judge {
public:
  Judge(const PositionGrid& grid, Projection projection, const Raster& raster)
      : grid_(grid), projection_(projection), thickness_(turned_px * pixel_size(raster)) {}

  Vec2 image(const Vec3& p) const { return projection_ == Projection::orthographic ? Vec2(p) : Vec2(p) / -p.z; }
  Vec2 image(const GridPoint& p) const { return image(from_grid(grid_, p)); }

  template <typename Point>
  Shown shown(const std::array<Point, 3>& corner) const {
    const Vec2 a = image(corner[0]), u = image(corner[1]) - a, v = image(corner[2]) - a;
    return {u.x * v.y - u.y * v.x, std::max({glm::length(u), glm::length(v), glm::length(v - u)})};
  }

  bool is_thick(const Shown& shown) const { return std::abs(shown.twice_area) > thickness_ * shown.longest; }

  /// How thick a turned triangle is, image units; 0 where it is not turned.
  /// @param turn the sign that the area must have, 0: any
  double turned_by(const std::array<GridPoint, 3>& corner, int turn) const {
    const Shown seen = shown(corner);
    if (turn == 0 || (seen.twice_area > 0) == (turn > 0) || std::abs(seen.twice_area) <= thickness_ * seen.longest) return 0;
    return std::abs(seen.twice_area) / seen.longest;
  }

private:
  const PositionGrid& grid_;
  Projection projection_;
  double thickness_;
};

/// How the eye sees a source triangle turn; 0 when it is seen edge-on.
int turn_of(const std::array<Vec3, 3>& source) {
  const Vec3 u = source[1] - source[0], v = source[2] - source[0];
  const auto largest = [](const Vec3& p) { return std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}); };
  const double volume = glm::dot(source[0], glm::cross(u, v)), size = std::max({largest(source[0]), largest(source[1]), largest(source[2])});
  if (std::abs(volume) <= edge_on * size * size * 2 * std::max({largest(u), largest(v), largest(v - u)})) return 0;
  return volume > 0 ? 1 : -1;
}

/// Of one primitive: the sign that the area of each triangle's image must have. All of it is of one branch of the surface, so
/// that images turn as most of them do against their sources.
std::vector<std::int8_t> turns_of(const Primitive& primitive, const Judge& judge) {
  const Attribute* source = find_attribute(primitive, "_SOURCE_POSITION");
  std::vector<std::int8_t> turn(source == nullptr ? 0 : primitive.indices.size() / 3);
  std::atomic<long long> votes = 0;
  parallel_each(turn.size(), 4096, [&](std::size_t f) {
    std::array<Vec3, 3> from, drawn;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t v = primitive.indices[3 * f + k];
      from[k] = Vec3(source->values[3 * v], source->values[3 * v + 1], source->values[3 * v + 2]);
      drawn[k] = Vec3(primitive.positions[v]);
    }
    turn[f] = static_cast<std::int8_t>(turn_of(from));
    if (const Shown shown = judge.shown(drawn); judge.is_thick(shown)) votes.fetch_add(shown.twice_area > 0 ? turn[f] : -turn[f], std::memory_order_relaxed);
  });
  if (votes < 0)
    for (std::int8_t& t : turn) t = static_cast<std::int8_t>(-t);
  return turn;
}

template <typename Visit>
void each_triangle_mesh(Scene& scene, Visit&& visit) {
  std::size_t index = 0;
  for (Mesh& mesh : scene.meshes)
    for (Primitive& primitive : mesh.primitives)
      if (primitive.topology == Topology::triangles) visit(index++, primitive);
}

/// A position of the file, where it goes, and the triangles around it.
struct Node {
  Vec3f position;
  Vec2 wanted;           ///< where it should appear
  GridPoint point;
  bool may_move = false;
  std::vector<std::uint32_t> faces;
};

struct Face {
  std::array<std::uint32_t, 3> node;
  int turn;
};

/// The turned triangles and what lies around their corners.
struct Neighbourhood {
  std::vector<Node> nodes;
  std::vector<Face> faces;
};

using Turns = std::vector<std::vector<std::int8_t>>;

class Mender {
public:
  Mender(Scene& warped, const PositionGrid& grid, Projection projection, const Raster& raster)
      : warped_(warped), grid_(grid), judge_(grid, projection, raster), px_(1 / pixel_size(raster)) {
    each_triangle_mesh(warped_, [&](std::size_t, Primitive& primitive) { turns_.push_back(turns_of(primitive, judge_)); });
  }

  PackedFlips run() {
    PackedFlips flips;
    for (int round = 0;; ++round) {
      const std::map<Key, std::uint32_t> corners = corners_of_turned(flips.left);
      if (round == 0) flips.found = flips.left;
      if (flips.left == 0 || round == most_rounds) return flips;
      Neighbourhood around = gather(corners);
      if (!mend(around)) return flips;
      move(around, corners, flips.moved_px);
    }
  }

private:
  /// The positions of the corners of turned triangles, numbered in order.
  std::map<Key, std::uint32_t> corners_of_turned(std::size_t& turned) const {
    std::map<Key, std::uint32_t> corners;
    turned = 0;
    each_triangle_mesh(warped_, [&](std::size_t index, const Primitive& primitive) {
      const std::vector<std::int8_t>& turn = turns_[index];
      std::vector<std::uint8_t> is_turned(turn.size(), 0);
      parallel_each(turn.size(), 4096, [&](std::size_t f) {
        std::array<GridPoint, 3> corner;
        for (std::size_t k = 0; k < 3; ++k) corner[k] = to_grid(grid_, primitive.positions[primitive.indices[3 * f + k]]);
        is_turned[f] = judge_.turned_by(corner, turn[f]) != 0;
      });
      for (std::size_t f = 0; f < turn.size(); ++f) {
        if (!is_turned[f]) continue;
        ++turned;
        for (std::size_t k = 0; k < 3; ++k) corners.try_emplace(key_of(primitive.positions[primitive.indices[3 * f + k]]));
      }
    });
    std::uint32_t number = 0;
    for (auto& [position, node] : corners) node = number++;
    return corners;
  }

  Neighbourhood gather(const std::map<Key, std::uint32_t>& corners) const {
    Neighbourhood around;
    for (const auto& [position, node] : corners) {
      const Vec3f p(std::get<0>(position), std::get<1>(position), std::get<2>(position));
      around.nodes.push_back({p, wanted_at(position), to_grid(grid_, p), true, {}});
    }
    each_triangle_mesh(warped_, [&](std::size_t index, const Primitive& primitive) {
      std::vector<std::int32_t> node_of(primitive.positions.size());
      parallel_each(node_of.size(), 4096, [&](std::size_t v) {
        const auto found = corners.find(key_of(primitive.positions[v]));
        node_of[v] = found == corners.end() ? -1 : static_cast<std::int32_t>(found->second);
      });
      for (std::size_t f = 0; f < turns_[index].size(); ++f) {
        const std::uint32_t* corner = &primitive.indices[3 * f];
        if (std::none_of(corner, corner + 3, [&](std::uint32_t v) { return node_of[v] >= 0; })) continue;
        Face face{{}, turns_[index][f]};
        for (std::size_t k = 0; k < 3; ++k) {
          const std::int32_t known = node_of[corner[k]];
          face.node[k] = known >= 0 ? static_cast<std::uint32_t>(known) : static_cast<std::uint32_t>(around.nodes.size());
          if (known < 0) around.nodes.push_back({primitive.positions[corner[k]], {}, to_grid(grid_, primitive.positions[corner[k]]), false, {}});
          around.nodes[face.node[k]].faces.push_back(static_cast<std::uint32_t>(around.faces.size()));
        }
        around.faces.push_back(face);
      }
    });
    return around;
  }

  double turned_by(const Neighbourhood& around, const Face& face) const {
    return judge_.turned_by({around.nodes[face.node[0]].point, around.nodes[face.node[1]].point, around.nodes[face.node[2]].point}, face.turn);
  }

  /// How many triangles around a node are turned, or have two corners that meet although they did not before; and by how much.
  std::pair<int, double> faults_at(const Neighbourhood& around, const Node& node) const {
    std::pair<int, double> faults{0, 0};
    for (const std::uint32_t f : node.faces) {
      const Face& face = around.faces[f];
      const double turned = turned_by(around, face);
      faults.first += turned != 0;
      faults.second += turned;
      for (const std::uint32_t other : face.node) {
        const Node& at = around.nodes[other];
        faults.first += &at != &node && at.point == node.point && to_grid(grid_, at.position) != to_grid(grid_, node.position);
      }
    }
    return faults;
  }

  /// Every corner of a turned triangle, in the order of positions, goes where most triangles turn back, or are less turned; of
  /// such places to that nearest to where it should appear.
  bool mend(Neighbourhood& around) const {
    bool moved = false;
    const int largest = (1 << grid_.bits) - 1;
    for (Node& node : around.nodes) {
      if (!node.may_move) continue;
      const std::pair<int, double> before = faults_at(around, node);
      if (before.first == 0) continue;
      const GridPoint from = node.point;
      std::pair<std::pair<int, double>, double> best{before, 0}; // faults, distance
      GridPoint best_point = from;
      for (int x = -reach; x <= reach; ++x)
        for (int y = -reach; y <= reach; ++y)
          for (int z = -reach; z <= reach; ++z) {
            const GridPoint to = from + GridPoint(x, y, z);
            if (std::min({to.x, to.y, to.z}) < 0 || std::max({to.x, to.y, to.z}) > largest) continue;
            node.point = to;
            const std::pair tried{faults_at(around, node), glm::length(judge_.image(to) - node.wanted)};
            if (tried.first < before && (best_point == from || tried < best)) best = tried, best_point = to;
          }
      node.point = best_point;
      moved = moved || best_point != from;
    }
    return moved;
  }

  Vec2 wanted_at(const Key& position) const {
    const auto moved = wanted_.find(position);
    return moved != wanted_.end() ? moved->second : judge_.image(Vec3(std::get<0>(position), std::get<1>(position), std::get<2>(position)));
  }

  void move(const Neighbourhood& around, const std::map<Key, std::uint32_t>& corners, double& moved_px) {
    for (const auto& [position, number] : corners) {
      const Node& node = around.nodes[number];
      if (node.point == to_grid(grid_, node.position)) continue;
      moved_px = std::max(moved_px, px_ * glm::length(judge_.image(node.point) - node.wanted));
      wanted_.try_emplace(key_of(Vec3f(from_grid(grid_, node.point))), node.wanted);
    }
    each_triangle_mesh(warped_, [&](std::size_t, Primitive& primitive) {
      parallel_each(primitive.positions.size(), 4096, [&](std::size_t v) {
        const auto found = corners.find(key_of(primitive.positions[v]));
        if (found == corners.end()) return;
        const Node& node = around.nodes[found->second];
        if (node.point != to_grid(grid_, node.position)) primitive.positions[v] = Vec3f(from_grid(grid_, node.point));
      });
    });
  }

  Scene& warped_;
  const PositionGrid& grid_;
  Judge judge_;
  double px_;
  Turns turns_;
  std::map<Key, Vec2> wanted_; ///< of positions that were moved: where they should appear
};

} // namespace

PackedFlips mend_packed_flips(Scene& warped, WriteOptions& write, Projection projection, const Raster& raster) {
  write.grid = position_grid(warped, write);
  if (!write.grid) return {};
  return Mender(warped, *write.grid, projection, raster).run();
}

} // namespace domewarp
