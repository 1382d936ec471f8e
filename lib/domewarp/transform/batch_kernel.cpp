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

// Finds out whether all points are fit: their squares neither overflow nor lose digits, and none is straight behind.
struct Fitness {
  using Bits = hn::RebindToUnsigned<Tag>;
  hn::Vec<Bits> least = hn::BitCast(Bits(), Broadcast(1)), most = hn::Zero(Bits());

  // As bits, which are ordered like positive numbers, with nan above them; integer units are less busy.
  // @param divisor of the half-angle's tangent
  HWY_INLINE void Add(V divisor, V d2) {
    least = hn::Min(hn::BitCast(Bits(), divisor), least);
    most = hn::Max(hn::BitCast(Bits(), d2), most);
  }
  static HWY_INLINE Mask Holds(V divisor, V d2) {
    return hn::And(hn::Ge(divisor, Broadcast(0x1p-50F)), hn::Le(d2, Broadcast(0x1p100F)));
  }
  HWY_INLINE bool All() const {
    return hn::AllTrue(Tag(), Holds(hn::BitCast(Tag(), least), hn::BitCast(Tag(), most)));
  }
};

// The lower of two numbers one of which is negative; by their bits, as integer units are less busy.
HWY_INLINE V LowerNumber(V a, V b) {
  const hn::RebindToUnsigned<Tag> d;
  return hn::BitCast(Tag(), hn::Max(hn::BitCast(d, a), hn::BitCast(d, b)));
}

// What stage 1 leaves for stage 2.
struct Place {
  V t;       // u scale; negative where R and not R / sin(theta) is tabulated
  V inverse; // scale / rho, or scale / r there; negative beyond the rim: -scale / what divides x on the tangent extension
  V depth;
  V finer;   // what t lacks
};

// Half-angle: tan(theta / 2) = n / o.
struct HalfAngle {
  V r, depth, n, o, d2;

  HWY_INLINE HalfAngle(V x, V y, V z) {
    const V r2 = hn::MulAdd(x, x, hn::Mul(y, y));
    d2 = hn::MulAdd(z, z, r2);
    r = hn::Sqrt(r2);
    depth = hn::Sqrt(d2);
    const V a = hn::Add(depth, hn::Abs(z));
    n = hn::IfNegativeThenElse(z, r, a);
    o = hn::IfNegativeThenElse(z, a, r);
  }
};

// 1 / v to 5 %, of positive v.
HWY_INLINE V RoughInverse(V v) {
  const hn::RebindToUnsigned<Tag> d;
  return hn::BitCast(Tag(), hn::Sub(hn::Set(d, 0x7EF127EAU), hn::BitCast(d, v)));
}

// What rounding took from `product` = a b.
HWY_INLINE V RestOfProduct(V a, V b, V product) {
#if HWY_NATIVE_FMA
  return hn::MulSub(a, b, product);
#else
  const auto upper = [](V v) HWY_ATTR {
    const V shifted = hn::Mul(v, Broadcast(4097));
    return hn::Sub(shifted, hn::Sub(shifted, v));
  };
  const V a1 = upper(a), b1 = upper(b), a2 = hn::Sub(a, a1), b2 = hn::Sub(b, b1);
  const V first = hn::Add(hn::Add(hn::Sub(hn::Mul(a1, b1), product), hn::Mul(a1, b2)), hn::Mul(a2, b1));
  return hn::Add(first, hn::Mul(a2, b2));
#endif
}

// c - a b, where that is small beside c.
HWY_INLINE V Remainder(V c, V a, V b) {
#if HWY_NATIVE_FMA
  return hn::NegMulAdd(a, b, c);
#else
  const V product = hn::Mul(a, b);
  return hn::Sub(hn::Sub(c, product), RestOfProduct(a, b, product));
#endif
}

// What rounding took from `sum` = a + b, of numbers that are not negative.
HWY_INLINE V RestOfSum(V a, V b, V sum) { return hn::Sub(hn::Min(a, b), hn::Sub(sum, hn::Max(a, b))); }

// What t = scale n / bottom, bottom = n + alpha o, lacks by the rounding of the squares, roots and sums before it: in pairs of
// numbers, the second what rounding took from the first. alpha is a power of 2. Leaves a twentieth.
HWY_INLINE V Finer(const V* p, const HalfAngle& half, V bottom, V t, V alpha, V scale) {
  V square[3], rest[3];
  for (int i = 0; i < 3; ++i) {
    square[i] = hn::Mul(p[i], p[i]);
    rest[i] = RestOfProduct(p[i], p[i], square[i]);
  }
  const V r2 = hn::Add(square[0], square[1]), d2 = hn::Add(r2, square[2]);
  const V rest_r2 = hn::Add(hn::Add(rest[0], rest[1]), RestOfSum(square[0], square[1], r2));
  const V rest_d2 = hn::Add(hn::Add(rest_r2, rest[2]), RestOfSum(r2, square[2], d2));
  const auto rest_of_root = [](V root, V of, V rest_of) HWY_ATTR {
    return hn::Mul(hn::Add(Remainder(of, root, root), rest_of), hn::Mul(Broadcast(0.5F), RoughInverse(root)));
  };
  const V rest_r = rest_of_root(half.r, r2, rest_r2), rest_d = rest_of_root(half.depth, d2, rest_d2);
  const V forward = hn::Abs(p[2]), rest_a = hn::Add(rest_d, RestOfSum(half.depth, forward, hn::Add(half.depth, forward)));
  const V rest_n = hn::IfNegativeThenElse(p[2], rest_r, rest_a), rest_o = hn::IfNegativeThenElse(p[2], rest_a, rest_r);
  const V rest_bottom = hn::Add(hn::MulAdd(alpha, rest_o, rest_n), RestOfSum(half.n, hn::Mul(alpha, half.o), bottom));
  const V top = hn::Mul(scale, half.n), rest_top = hn::MulAdd(scale, rest_n, RestOfProduct(scale, half.n, top));
  const V left = hn::NegMulAdd(t, rest_bottom, hn::Add(Remainder(top, t, bottom), rest_top));
  return hn::Mul(left, RoughInverse(bottom));
}

// Stage 1: where on the table a point is.
struct Locator {
  Interleaving interleaving;
  V alpha, scale, beyond_z, beyond_r, u_max, u_ahead, u_blind, least;
  Fitness fitness{};

  HWY_INLINE explicit Locator(const FloatTable& table)
      : alpha(Broadcast(table.alpha)), scale(Broadcast(table.scale)), beyond_z(Broadcast(table.beyond_z)),
        beyond_r(Broadcast(table.beyond_r)), u_max(Broadcast(table.u_max)), u_ahead(Broadcast(table.u_ahead)),
        u_blind(Broadcast(table.u_blind)), least(Broadcast(-1 / FloatTable::blind_radius)) {}

  template <bool fine, bool behind, bool split>
  HWY_INLINE void Run(const ConstPoints& in, std::size_t i, const Points& out, Place& place) {
    const Tag d;
    V p[3];
    if (split) {
      p[0] = hn::LoadU(d, in.x + i);
      p[1] = hn::LoadU(d, in.y + i);
      p[2] = hn::LoadU(d, in.z + i);
    } else {
      interleaving.Load(in.x + 3 * i, p);
    }
    const HalfAngle half(p[0], p[1], p[2]);
    fitness.Add(half.o, half.d2);
    const V bottom = hn::MulAdd(alpha, half.o, half.n);
    const V line = hn::MulSub(beyond_z, p[2], hn::Mul(beyond_r, half.r));
    const Mask extended = hn::Le(half.n, hn::Mul(u_blind, bottom)), inside = hn::Le(half.n, hn::Mul(u_max, bottom));
    const V beyond = LowerNumber(hn::IfThenElseZero(extended, line), hn::Mul(least, half.r));
    V divisor = hn::IfThenElse(inside, half.depth, beyond);
    Mask far;
    if (behind) {
      far = hn::And(inside, hn::Gt(half.n, hn::Mul(u_ahead, bottom)));
      divisor = hn::IfThenElse(far, half.r, divisor);
    }
    const V inverse = hn::Div(scale, hn::Mul(divisor, bottom)); // one division for both
    V t = hn::Mul(half.n, hn::Mul(divisor, inverse));
    if (fine) place.finer = Finer(p, half, bottom, t, alpha, scale);
    if (behind) t = hn::IfThenElse(far, hn::Neg(t), t);
    place.t = t;
    place.inverse = hn::Mul(bottom, inverse);
    if (split) hn::StoreU(half.depth, d, out.z + i);
    else place.depth = half.depth;
  }
};

// Coefficients of up to 32 pieces, looked up by permutation of registers; from memory where vectors are short.
template <int pieces, int powers>
struct Coefficients {
  static constexpr bool in_registers = lanes >= 8;
  static constexpr int registers = in_registers && pieces > static_cast<int>(lanes) ? pieces / static_cast<int>(lanes) : 1;
  const float (*rows)[FloatTable::most_pieces];
  V values[powers][registers];

  HWY_INLINE explicit Coefficients(const float (*from)[FloatTable::most_pieces]) : rows(from + FloatTable::most_powers - powers) {
    if (!in_registers) return;
    for (int power = 0; power < powers; ++power)
      for (int i = 0; i < registers; ++i) values[power][i] = hn::Load(Tag(), rows[power] + static_cast<std::size_t>(i) * lanes);
  }

  HWY_INLINE V Pick(int power, V piece, Indices index) const {
    if constexpr (!in_registers) {
      const Indices in_row = hn::And(index, hn::Set(hn::RebindToSigned<Tag>(), FloatTable::most_pieces - 1));
      return hn::GatherIndex(Tag(), rows[power], in_row);
    } else {
      const auto lane = LaneOf(index);
#if HWY_ARCH_X86 && HWY_TARGET <= HWY_AVX3
      if constexpr (registers == 2) return V{_mm512_permutex2var_ps(values[power][0].raw, lane.raw, values[power][1].raw)};
#endif
      V value = hn::TableLookupLanes(values[power][0], lane);
      for (int i = 1; i < registers; ++i) {
        const Mask here = hn::Gt(piece, Broadcast(static_cast<float>(i * static_cast<int>(lanes)) - 0.5F));
        value = hn::IfThenElse(here, hn::TableLookupLanes(values[power][i], lane), value);
      }
      return value;
    }
  }

  static HWY_INLINE auto LaneOf(Indices index) {
#if HWY_ARCH_X86 && HWY_TARGET <= HWY_AVX2
    return Lanes{index.raw}; // takes the low bits
#else
    return hn::IndicesFromVec(Tag(), hn::And(index, hn::Set(hn::RebindToSigned<Tag>(), static_cast<int>(lanes) - 1)));
#endif
  }

  HWY_INLINE V Evaluate(V x, V piece, Indices index) const {
    V value = Pick(0, piece, index);
    for (int power = 1; power < powers; ++power) value = hn::MulAdd(value, x, Pick(power, piece, index));
    return value;
  }
};

// Stage 2: the polynomials.
template <int pieces, int degree, bool fine, bool behind, bool perspective, bool split>
struct Finisher {
  Interleaving interleaving;
  Coefficients<pieces, degree + 1> k, g;
  V k_beyond, g_beyond, last_ahead;

  HWY_INLINE explicit Finisher(const FloatTable& table)
      : k(table.k), g(perspective ? table.g : table.k), k_beyond(Broadcast(-1 / table.scale)), g_beyond(Broadcast(table.g_beyond)),
        last_ahead(Broadcast(table.last_ahead)) {}

  HWY_INLINE void Run(const ConstPoints& in, const Place& place, std::size_t i, const Points& out) const {
    const Tag d;
    const V magic = Broadcast(0x1.8p23F), t = behind ? hn::Abs(place.t) : place.t;
    V shifted = hn::Add(t, magic);
    if (behind) { // rounding must not take the wrong side's piece
      const V last = hn::Add(last_ahead, magic);
      shifted = hn::IfNegativeThenElse(place.t, hn::Max(shifted, hn::Add(last, Broadcast(1))), hn::Min(shifted, last));
    }
    const V piece = hn::Sub(shifted, magic);
    V x = hn::Sub(t, piece);
    if (fine) x = hn::Add(x, place.finer);
    const Indices index = hn::BitCast(hn::RebindToSigned<Tag>(), shifted);
    V factor = hn::Mul(place.inverse, hn::IfNegativeThenElse(place.inverse, k_beyond, k.Evaluate(x, piece, index)));
    V z{};
    if (!split) z = place.depth;
    if (perspective) {
      if (split) z = hn::LoadU(d, out.z + i);
      const V w = hn::Mul(z, hn::IfNegativeThenElse(place.inverse, g_beyond, g.Evaluate(x, piece, index)));
      factor = hn::Mul(factor, w);
      z = hn::Neg(w);
    }
    if (split) {
      hn::StoreU(hn::Mul(hn::LoadU(d, in.x + i), factor), d, out.x + i);
      hn::StoreU(hn::Mul(hn::LoadU(d, in.y + i), factor), d, out.y + i);
      if (perspective) hn::StoreU(z, d, out.z + i);
    } else {
      interleaving.Store(in.x + 3 * i, factor, z, out.x + 3 * i);
    }
  }
};

// The second stage follows the first at a distance, so that the division and roots of one overlap the arithmetic of the
// other.
template <int pieces, int degree, bool fine, bool behind, bool perspective, bool split>
HWY_NOINLINE bool Map(const FloatTable& table, const ConstPoints& in, const Points& out) {
  Locator locator(table);
  const Finisher<pieces, degree, fine, behind, perspective, split> finisher(table);
  constexpr std::size_t lag = 6, vectors = batch_block / lanes;
  Place places[2 * lag];
  for (std::size_t i = 0; i < lag; ++i) locator.template Run<fine, behind, split>(in, i * lanes, out, places[i]);
  for (std::size_t i = lag; i < vectors; ++i) {
    locator.template Run<fine, behind, split>(in, i * lanes, out, places[i % (2 * lag)]);
    finisher.Run(in, places[(i - lag) % (2 * lag)], (i - lag) * lanes, out);
  }
  for (std::size_t i = vectors - lag; i < vectors; ++i) finisher.Run(in, places[i % (2 * lag)], i * lanes, out);
  return !locator.fitness.All();
}

template <int pieces, int degree, bool fine, bool behind, bool perspective>
bool MapLayout(const FloatTable& table, const ConstPoints& in, const Points& out) {
  return in.stride == 1 ? Map<pieces, degree, fine, behind, perspective, true>(table, in, out)
                        : Map<pieces, degree, fine, behind, perspective, false>(table, in, out);
}

template <int pieces, int degree, bool fine>
bool MapWith(const FloatTable& table, const ConstPoints& in, const Points& out, BatchOutput output) {
  const bool behind = table.reaches_behind();
  if (output == BatchOutput::image)
    return behind ? MapLayout<pieces, degree, fine, true, false>(table, in, out)
                  : MapLayout<pieces, degree, fine, false, false>(table, in, out);
  return behind ? MapLayout<pieces, degree, fine, true, true>(table, in, out) : MapLayout<pieces, degree, fine, false, true>(table, in, out);
}

bool MapInto(const FloatTable& table, const ConstPoints& in, const Points& out, BatchOutput output) {
  if (table.fine) return MapWith<32, 7, true>(table, in, out, output);
  if (table.degree == 7) return MapWith<8, 7, false>(table, in, out, output);
  switch (table.pieces) {
  case 8: return MapWith<8, 5, false>(table, in, out, output);
  case 16: return MapWith<16, 5, false>(table, in, out, output);
  default: return MapWith<32, 5, false>(table, in, out, output);
  }
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
  if (!streams) return MapInto(table, in, out, output);
  HWY_ALIGN float x[3 * batch_block];
  if (out.stride == 3) {
    const bool unfit = MapInto(table, in, {x, x + 1, x + 2, 3}, output);
    Stream(x, out.x, 3 * batch_block);
    return unfit;
  }
  const bool unfit = MapInto(table, in, {x, x + batch_block, x + 2 * batch_block, 1}, output);
  Stream(x, out.x, batch_block);
  Stream(x + batch_block, out.y, batch_block);
  Stream(x + 2 * batch_block, out.z, batch_block);
  return unfit;
}

void FindUnfit(const ConstPoints& in, std::uint8_t* flags) {
  const Tag d;
  HWY_ALIGN float marks[lanes];
  for (std::size_t i = 0; i < batch_block; i += lanes) {
    const HalfAngle half(hn::LoadU(d, in.x + i), hn::LoadU(d, in.y + i), hn::LoadU(d, in.z + i));
    hn::Store(hn::IfThenElse(Fitness::Holds(half.o, half.d2), hn::Zero(d), Broadcast(1)), d, marks);
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
