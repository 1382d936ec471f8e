// SPDX-License-Identifier: Apache-2.0
// Compiled once per instruction set, as the batch kernel is.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "map_floor.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "map_floor.h"

HWY_BEFORE_NAMESPACE();
namespace domewarp::bench {
namespace HWY_NAMESPACE {
namespace {

void MapFloor(const ConstPoints& in, const Points& out, std::size_t count) {
  namespace hn = hwy::HWY_NAMESPACE;
  const hn::ScalableTag<float> d;
  const float *const from_x = in.x, *const from_y = in.y, *const from_z = in.z;
  float *const to_x = out.x, *const to_y = out.y, *const to_z = out.z;
  for (std::size_t i = 0; i + hn::Lanes(d) <= count; i += hn::Lanes(d)) {
    const auto x = hn::LoadU(d, from_x + i), y = hn::LoadU(d, from_y + i), z = hn::LoadU(d, from_z + i);
    const auto r2 = hn::MulAdd(x, x, hn::Mul(y, y));
    const auto r = hn::Sqrt(r2), depth = hn::Sqrt(hn::MulAdd(z, z, r2));
    const auto factor = hn::Div(r, depth);
    hn::StoreU(hn::Mul(x, factor), d, to_x + i);
    hn::StoreU(hn::Mul(y, factor), d, to_y + i);
    hn::StoreU(depth, d, to_z + i);
  }
}

} // namespace
} // namespace HWY_NAMESPACE
} // namespace domewarp::bench
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace domewarp::bench {

HWY_EXPORT(MapFloor);

void map_floor(const ConstPoints& in, const Points& out, std::size_t count) { HWY_DYNAMIC_DISPATCH(MapFloor)(in, out, count); }

} // namespace domewarp::bench
#endif
