// SPDX-License-Identifier: Apache-2.0
// Compiled once per instruction set (Highway's foreach_target), so nothing here may call inline functions that other
// files share: the linker could keep the copy of the wrong instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "domewarp/transform/batch_kernel.cpp"
#define HWY_DISABLED_TARGETS HWY_SSSE3 // SSE4 and scalar serve what has no AVX2
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "domewarp/transform/batch_kernel.h"

HWY_BEFORE_NAMESPACE();
namespace domewarp {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

using Tag = hn::ScalableTag<float>;
using V = hn::Vec<Tag>;
using Mask = hn::Mask<Tag>;
using Indices = hn::Vec<hn::RebindToSigned<Tag>>;
constexpr std::size_t lanes = HWY_LANES(float);

HWY_INLINE V Broadcast(float value) { return hn::Set(Tag(), value); }

// The three vectors that hold x y z x y z ... and the lanes of the first two that belong to coordinate 0, 1, 2.
// As the number of lanes and 3 have no common factor, the lanes of one coordinate in the three vectors are all
// different: a blend brings them together, and one permutation sorts them.
struct Interleaving {
  Mask in_first[3], in_second[3];
  decltype(hn::SetTableIndices(Tag(), static_cast<const int*>(nullptr))) gather[3], scatter[3];

  HWY_INLINE Interleaving() {
    for (int c = 0; c < 3; ++c) {
      HWY_ALIGN float first[lanes], second[lanes];
      HWY_ALIGN int from[lanes], to[lanes];
      for (std::size_t i = 0; i < lanes; ++i) {
        first[i] = i % 3 == static_cast<std::size_t>(c) ? 1.0F : 0.0F;
        second[i] = (lanes + i) % 3 == static_cast<std::size_t>(c) ? 1.0F : 0.0F;
        const std::size_t lane = (3 * i + static_cast<std::size_t>(c)) % lanes;
        from[i] = static_cast<int>(lane);
        to[lane] = static_cast<int>(i);
      }
      in_first[c] = hn::Gt(hn::Load(Tag(), first), hn::Zero(Tag()));
      in_second[c] = hn::Gt(hn::Load(Tag(), second), hn::Zero(Tag()));
      gather[c] = hn::SetTableIndices(Tag(), from);
      scatter[c] = hn::SetTableIndices(Tag(), to);
    }
  }

  HWY_INLINE void Load(const float* from, V* xyz) const {
    const V a = hn::LoadU(Tag(), from), b = hn::LoadU(Tag(), from + lanes), c = hn::LoadU(Tag(), from + 2 * lanes);
    for (int i = 0; i < 3; ++i)
      xyz[i] = hn::TableLookupLanes(hn::IfThenElse(in_first[i], a, hn::IfThenElse(in_second[i], b, c)), gather[i]);
  }

  HWY_INLINE void Store(const V* xyz, float* to) const {
    const V x = hn::TableLookupLanes(xyz[0], scatter[0]), y = hn::TableLookupLanes(xyz[1], scatter[1]);
    const V z = hn::TableLookupLanes(xyz[2], scatter[2]);
    // Coordinate c is in the first vector's lanes in_first[c], and so on.
    hn::StoreU(hn::IfThenElse(in_first[0], x, hn::IfThenElse(in_first[1], y, z)), Tag(), to);
    hn::StoreU(hn::IfThenElse(in_second[0], x, hn::IfThenElse(in_second[1], y, z)), Tag(), to + lanes);
    const Mask third_z = hn::Or(hn::And(in_first[0], in_second[1]), hn::And(in_first[1], in_second[0]));
    const Mask third_x = hn::Or(hn::And(in_first[1], in_second[2]), hn::And(in_first[2], in_second[1]));
    hn::StoreU(hn::IfThenElse(third_z, z, hn::IfThenElse(third_x, x, y)), Tag(), to + 2 * lanes);
  }
};

// Squares neither overflow nor lose digits, and the direction is not straight behind.
HWY_INLINE Mask IsFit(V r2, V d2, V z) {
  const Mask large_enough = hn::Ge(hn::Min(d2, hn::Max(r2, hn::Neg(z))), Broadcast(0x1p-100F));
  return hn::And(large_enough, hn::Le(d2, Broadcast(0x1p100F)));
}

// What stage 1 leaves for stage 2.
struct Scratch {
  HWY_ALIGN float x[batch_block], y[batch_block], t[batch_block], depth[batch_block];
  HWY_ALIGN float measure[batch_block]; // what divides x within the branch, besides Q: rho, or r behind
  HWY_ALIGN float beyond[batch_block];  // what divides x on the tangent extension
  HWY_ALIGN float out[3 * batch_block];
};

// Stage 1: where on the table a point is. @return whether all points are fit.
template <bool behind>
HWY_INLINE bool Locate(const FloatTable& table, const ConstPoints& in, Scratch& scratch) {
  const Tag d;
  const Interleaving interleaving;
  const V alpha = Broadcast(table.alpha), scale = Broadcast(table.scale);
  const V beyond_z = Broadcast(table.beyond_z), beyond_r = Broadcast(table.beyond_r);
  const V t_blind = Broadcast(table.t_blind), least = Broadcast(1 / FloatTable::blind_radius);
  Mask fit = hn::Eq(alpha, alpha);
  for (std::size_t i = 0; i < batch_block; i += lanes) {
    V p[3];
    if (in.stride == 1) {
      p[0] = hn::LoadU(d, in.x + i);
      p[1] = hn::LoadU(d, in.y + i);
      p[2] = hn::LoadU(d, in.z + i);
    } else {
      interleaving.Load(in.x + 3 * i, p);
    }
    const V r2 = hn::MulAdd(p[0], p[0], hn::Mul(p[1], p[1])), d2 = hn::MulAdd(p[2], p[2], r2);
    fit = hn::And(fit, IsFit(r2, d2, p[2]));
    const V r = hn::Sqrt(r2), depth = hn::Sqrt(d2);
    const V a = hn::Add(depth, hn::Abs(p[2]));
    const Mask is_behind = hn::Gt(p[2], hn::Zero(d));
    const V n = hn::IfThenElse(is_behind, a, r), o = hn::IfThenElse(is_behind, r, a);
    const V t = hn::MulSub(hn::Div(n, hn::MulAdd(alpha, o, n)), scale, Broadcast(0.5F));
    const V nearest = hn::Mul(least, r);
    const V line = hn::NegMulAdd(beyond_z, p[2], hn::Mul(beyond_r, r));
    hn::Store(p[0], d, scratch.x + i);
    hn::Store(p[1], d, scratch.y + i);
    hn::Store(t, d, scratch.t + i);
    hn::Store(depth, d, scratch.depth + i);
    if (behind) hn::Store(hn::IfThenElse(hn::Gt(t, Broadcast(table.t_behind)), r, depth), d, scratch.measure + i);
    hn::Store(hn::IfThenElse(hn::Gt(t, t_blind), nearest, hn::Max(line, nearest)), d, scratch.beyond + i);
  }
  return hn::AllTrue(d, fit);
}

// Coefficients of up to 32 pieces in registers, looked up by permutation; from memory where vectors are short.
template <int pieces>
struct Coefficients {
  static constexpr bool in_registers = lanes >= 8;
  static constexpr int registers = in_registers ? pieces / static_cast<int>(lanes) : 1;
  const float (*rows)[FloatTable::most_pieces];
  V values[FloatTable::powers][registers];

  HWY_INLINE explicit Coefficients(const float (*from)[FloatTable::most_pieces]) : rows(from) {
    if (!in_registers) return;
    for (int power = 0; power < FloatTable::powers; ++power)
      for (int i = 0; i < registers; ++i) values[power][i] = hn::Load(Tag(), from[power] + static_cast<std::size_t>(i) * lanes);
  }

  // @param piece rounded, as float and as integer
  HWY_INLINE V Pick(int power, V piece, Indices index) const {
    if constexpr (!in_registers) return hn::GatherIndex(Tag(), rows[power], index);
    else {
      const auto lane = hn::IndicesFromVec(Tag(), hn::And(index, hn::Set(hn::RebindToSigned<Tag>(), static_cast<int>(lanes) - 1)));
      V value = hn::TableLookupLanes(values[power][0], lane);
      for (int i = 1; i < registers; ++i) {
        const Mask here = hn::Ge(piece, Broadcast(static_cast<float>(i * static_cast<int>(lanes))));
        value = hn::IfThenElse(here, hn::TableLookupLanes(values[power][i], lane), value);
      }
      return value;
    }
  }

  HWY_INLINE V Evaluate(V x, V piece, Indices index) const {
    V value = Pick(0, piece, index);
    for (int power = 1; power < FloatTable::powers; ++power) value = hn::MulAdd(value, x, Pick(power, piece, index));
    return value;
  }
};

// Stage 2: the polynomials and the one division.
template <int pieces, bool behind, bool perspective>
HWY_INLINE void Finish(const FloatTable& table, const Scratch& scratch, const Points& out) {
  const Tag d;
  const hn::RebindToSigned<Tag> di;
  const Interleaving interleaving;
  const Coefficients<pieces> q(table.q), g(perspective ? table.g : table.q);
  const V t_max = Broadcast(table.t_max), g_beyond = Broadcast(table.g_beyond), one = Broadcast(1);
  const V last = Broadcast(pieces - 0.5F - pieces * 0x1p-24F), magic = Broadcast(0x1.8p23F);
  for (std::size_t i = 0; i < batch_block; i += lanes) {
    const V t = hn::Load(d, scratch.t + i), depth = hn::Load(d, scratch.depth + i);
    const V within = hn::Min(t, last);
    const V shifted = hn::Add(within, magic), piece = hn::Sub(shifted, magic), x = hn::Sub(within, piece);
    const Indices index = hn::And(hn::BitCast(di, shifted), hn::Set(di, FloatTable::most_pieces - 1));
    const Mask inside = hn::Le(t, t_max);
    const V measure = behind ? hn::Load(d, scratch.measure + i) : depth;
    const V divisor = hn::IfThenElse(inside, hn::Mul(measure, q.Evaluate(x, piece, index)), hn::Load(d, scratch.beyond + i));
    V result[3];
    V factor = hn::Div(one, divisor);
    if (perspective) {
      const V w = hn::Mul(depth, hn::IfThenElse(inside, g.Evaluate(x, piece, index), g_beyond));
      factor = hn::Mul(factor, w);
      result[2] = hn::Neg(w);
    } else {
      result[2] = depth;
    }
    result[0] = hn::Mul(hn::Load(d, scratch.x + i), factor);
    result[1] = hn::Mul(hn::Load(d, scratch.y + i), factor);
    if (out.stride == 1) {
      hn::StoreU(result[0], d, out.x + i);
      hn::StoreU(result[1], d, out.y + i);
      hn::StoreU(result[2], d, out.z + i);
    } else {
      interleaving.Store(result, out.x + 3 * i);
    }
  }
}

template <int pieces, bool behind>
HWY_INLINE bool Map(const FloatTable& table, const ConstPoints& in, const Points& out, BatchOutput output, Scratch& scratch) {
  const bool fit = Locate<behind>(table, in, scratch);
  if (output == BatchOutput::image) Finish<pieces, behind, false>(table, scratch, out);
  else Finish<pieces, behind, true>(table, scratch, out);
  return !fit;
}

bool MapInto(const FloatTable& table, const ConstPoints& in, const Points& out, BatchOutput output, Scratch& scratch) {
  if (table.pieces == 16)
    return table.reaches_behind() ? Map<16, true>(table, in, out, output, scratch) : Map<16, false>(table, in, out, output, scratch);
  return table.reaches_behind() ? Map<32, true>(table, in, out, output, scratch) : Map<32, false>(table, in, out, output, scratch);
}

// Streams whole vectors; what is left before the first and after the last aligned one is stored as usual.
HWY_INLINE void Stream(const float* from, float* to, std::size_t count) {
  const Tag d;
  std::size_t i = 0;
  const std::size_t misplaced = reinterpret_cast<std::uintptr_t>(to) / sizeof(float) % lanes;
  for (const std::size_t head = misplaced == 0 ? 0 : lanes - misplaced; i < head; ++i) to[i] = from[i];
  for (; i + lanes <= count; i += lanes) hn::Stream(hn::LoadU(d, from + i), d, to + i);
  for (; i < count; ++i) to[i] = from[i];
}

bool MapBlock(const FloatTable& table, const ConstPoints& in, const Points& out, BatchOutput output, bool streams) {
  Scratch scratch;
  if (!streams) return MapInto(table, in, out, output, scratch);
  float* const x = scratch.out;
  if (out.stride == 3) {
    const bool unfit = MapInto(table, in, {x, x + 1, x + 2, 3}, output, scratch);
    Stream(x, out.x, 3 * batch_block);
    return unfit;
  }
  const bool unfit = MapInto(table, in, {x, x + batch_block, x + 2 * batch_block, 1}, output, scratch);
  Stream(x, out.x, batch_block);
  Stream(x + batch_block, out.y, batch_block);
  Stream(x + 2 * batch_block, out.z, batch_block);
  return unfit;
}

void FindUnfit(const ConstPoints& in, std::uint8_t* flags) {
  const Tag d;
  HWY_ALIGN float marks[lanes];
  for (std::size_t i = 0; i < batch_block; i += lanes) {
    const V x = hn::LoadU(d, in.x + i), y = hn::LoadU(d, in.y + i), z = hn::LoadU(d, in.z + i);
    const V r2 = hn::MulAdd(x, x, hn::Mul(y, y));
    hn::Store(hn::IfThenElse(IsFit(r2, hn::MulAdd(z, z, r2), z), hn::Zero(d), Broadcast(1)), d, marks);
    for (std::size_t lane = 0; lane < lanes; ++lane) flags[i + lane] = marks[lane] != 0;
  }
}

} // namespace
} // namespace HWY_NAMESPACE
} // namespace domewarp
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include <hwy/cache_control.h>

namespace domewarp {

HWY_EXPORT(MapBlock);
HWY_EXPORT(FindUnfit);

bool map_block(const FloatTable& table, const ConstPoints& in, const Points& out, BatchOutput output, bool streams) {
  return HWY_DYNAMIC_DISPATCH(MapBlock)(table, in, out, output, streams);
}

void find_unfit(const ConstPoints& in, std::uint8_t* flags) { HWY_DYNAMIC_DISPATCH(FindUnfit)(in, flags); }

void finish_streaming() { hwy::FlushStream(); }

} // namespace domewarp
#endif
