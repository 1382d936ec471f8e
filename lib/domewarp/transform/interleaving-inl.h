// SPDX-License-Identifier: Apache-2.0
// Included once per instruction set, by files that are compiled so.
#if defined(DOMEWARP_INTERLEAVING_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef DOMEWARP_INTERLEAVING_INL_H
#undef DOMEWARP_INTERLEAVING_INL_H
#else
#define DOMEWARP_INTERLEAVING_INL_H
#endif

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace domewarp {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

using Tag = hn::ScalableTag<float>;
using V = hn::Vec<Tag>;
using Mask = hn::Mask<Tag>;
constexpr std::size_t lanes = HWY_LANES(float);

HWY_INLINE V Broadcast(float value) { return hn::Set(Tag(), value); }

using Lanes = decltype(hn::SetTableIndices(Tag(), static_cast<const int*>(nullptr)));

// For each coordinate or each of the three vectors that hold x y z x y z ...: 1 for the lanes in the first and second
// vector that belong to the coordinate, where its lanes come from once brought together; 1 for the lanes that belong to z,
// the points they belong to.
struct InterleavedLanes {
  HWY_ALIGN int in_first[3][lanes]{}, in_second[3][lanes]{}, gather[3][lanes]{}, is_z[3][lanes]{}, point[3][lanes]{};

  constexpr InterleavedLanes() {
    for (std::size_t c = 0; c < 3; ++c)
      for (std::size_t i = 0; i < lanes; ++i) {
        in_first[c][i] = i % 3 == c;
        in_second[c][i] = (lanes + i) % 3 == c;
        gather[c][i] = static_cast<int>((3 * i + c) % lanes);
        is_z[c][i] = (c * lanes + i) % 3 == 2;
        point[c][i] = static_cast<int>((c * lanes + i) / 3);
      }
  }
};

// As the number of lanes and 3 have no common factor, the lanes of one coordinate in the three vectors are all
// different: a blend brings them together, and one permutation sorts them.
struct Interleaving {
  Mask in_first[3], in_second[3], is_z[3];
  Lanes gather[3], point[3];

  HWY_INLINE Interleaving() {
    static constexpr InterleavedLanes numbers;
    const hn::RebindToSigned<Tag> d;
    const auto mask = [&](const int* from) HWY_ATTR { return hn::RebindMask(Tag(), hn::Gt(hn::Load(d, from), hn::Zero(d))); };
    for (std::size_t c = 0; c < 3; ++c) {
      in_first[c] = mask(numbers.in_first[c]);
      in_second[c] = mask(numbers.in_second[c]);
      is_z[c] = mask(numbers.is_z[c]);
      gather[c] = hn::SetTableIndices(Tag(), numbers.gather[c]);
      point[c] = hn::SetTableIndices(Tag(), numbers.point[c]);
    }
  }

  HWY_INLINE void Load(const float* from, V* xyz) const {
    const V a = hn::LoadU(Tag(), from), b = hn::LoadU(Tag(), from + lanes), c = hn::LoadU(Tag(), from + 2 * lanes);
    for (int i = 0; i < 3; ++i)
      xyz[i] = hn::TableLookupLanes(hn::IfThenElse(in_first[i], a, hn::IfThenElse(in_second[i], b, c)), gather[i]);
  }

  // x factor, y factor, z for the points that `from` holds.
  HWY_INLINE void Store(const float* from, V factor, V z, float* to) const {
    for (std::size_t c = 0; c < 3; ++c) {
      const V xy = hn::LoadU(Tag(), from + c * lanes);
      const V product = hn::Mul(xy, hn::TableLookupLanes(factor, point[c]));
      hn::StoreU(hn::IfThenElse(is_z[c], hn::TableLookupLanes(z, point[c]), product), Tag(), to + c * lanes);
    }
  }
};

} // namespace
} // namespace HWY_NAMESPACE
} // namespace domewarp
HWY_AFTER_NAMESPACE();

#endif
