// SPDX-License-Identifier: Apache-2.0
// Compiled once per instruction set (Highway's foreach_target), so nothing here may call inline functions that other
// files share: the linker could keep the copy of the wrong instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "domewarp/transform/batch_kernel.cpp"
#define HWY_DISABLED_TARGETS HWY_SSSE3 // SSE4 and scalar serve what has no AVX2
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "domewarp/transform/batch_kernel.h"
#include "domewarp/transform/interleaving-inl.h"

HWY_BEFORE_NAMESPACE();
namespace domewarp {
namespace HWY_NAMESPACE {
namespace {

using Indices = hn::Vec<hn::RebindToSigned<Tag>>;

// Finds out whether all points are fit: their squares neither overflow nor lose digits, and none is straight behind.
struct Fitness {
  using Bits = hn::RebindToUnsigned<Tag>;
  hn::Vec<Bits> least = hn::BitCast(Bits(), Broadcast(1)), most = hn::Zero(Bits());

  // As bits, which are ordered like positive numbers, with nan above them; integer units are less busy.
  HWY_INLINE void Add(V z, V r, V d2) {
    least = hn::Min(hn::BitCast(Bits(), FromBehind(z, r)), least);
    most = hn::Max(hn::BitCast(Bits(), d2), most);
  }
  // What is small beside the backward axis and the eye.
  static HWY_INLINE V FromBehind(V z, V r) {
    const hn::RebindToSigned<Tag> d;
    return hn::BitCast(Tag(), hn::Max(hn::BitCast(d, hn::Neg(z)), hn::BitCast(d, r)));
  }
  static HWY_INLINE Mask Holds(V from_behind, V d2) {
    return hn::And(hn::Ge(from_behind, Broadcast(0x1p-50F)), hn::Le(d2, Broadcast(0x1p100F)));
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

using Reach = FloatTable::Reach;

// What the stages leave for the next.
struct Place {
  V p[3];    // the point, where its layout hides it
  V r;       // distance from the axis
  V at;      // u, or u steps for the cosine
  V inverse; // scale / what divides x; negative beyond the rim
  V depth;
  V finer;   // what u steps lacks
};

// Adding it rounds to whole numbers, which are then the lowest bits.
HWY_INLINE V Magic() { return Broadcast(0x1.8p23F); }
HWY_INLINE V PieceOf(V shifted) { return hn::Sub(shifted, Magic()); }

// Half-angle: tan(theta / 2) = n / o.
struct HalfAngle {
  V n, o;

  HWY_INLINE HalfAngle(V r, V z, V depth) {
    const V a = hn::Add(depth, hn::Abs(z));
    n = hn::IfNegativeThenElse(z, r, a);
    o = hn::IfNegativeThenElse(z, a, r);
  }
};

// 2^power / v to 5 %, of positive v.
HWY_INLINE V RoughInverse(V v, int power = 0) {
  const hn::RebindToUnsigned<Tag> d;
  return hn::BitCast(Tag(), hn::Sub(hn::Set(d, 0x7EF127EAU + (static_cast<unsigned>(power) << 23)), hn::BitCast(d, v)));
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

// What u = n / bottom, bottom = n + alpha o, lacks by the rounding of the squares, roots and sums before it: in pairs of
// numbers, the second what rounding took from the first. alpha is a power of 2. Leaves a twentieth.
HWY_INLINE V Finer(const V* p, V r, V depth, const HalfAngle& half, V bottom, V u, V alpha) {
  V square[3], rest[3];
  for (int i = 0; i < 3; ++i) {
    square[i] = hn::Mul(p[i], p[i]);
    rest[i] = RestOfProduct(p[i], p[i], square[i]);
  }
  const V r2 = hn::Add(square[0], square[1]), d2 = hn::Add(r2, square[2]);
  const V rest_r2 = hn::Add(hn::Add(rest[0], rest[1]), RestOfSum(square[0], square[1], r2));
  const V rest_d2 = hn::Add(hn::Add(rest_r2, rest[2]), RestOfSum(r2, square[2], d2));
  const auto rest_of_root = [](V root, V of, V rest_of) HWY_ATTR {
    return hn::Mul(hn::Add(Remainder(of, root, root), rest_of), RoughInverse(root, -1));
  };
  const V rest_r = rest_of_root(r, r2, rest_r2), rest_d = rest_of_root(depth, d2, rest_d2);
  const V forward = hn::Abs(p[2]), rest_a = hn::Add(rest_d, RestOfSum(depth, forward, hn::Add(depth, forward)));
  const V rest_n = hn::IfNegativeThenElse(p[2], rest_r, rest_a), rest_o = hn::IfNegativeThenElse(p[2], rest_a, rest_r);
  const V rest_bottom = hn::Add(hn::MulAdd(alpha, rest_o, rest_n), RestOfSum(half.n, hn::Mul(alpha, half.o), bottom));
  const V left = hn::NegMulAdd(u, rest_bottom, hn::Add(Remainder(half.n, u, bottom), rest_n));
  return hn::Mul(left, RoughInverse(bottom));
}

HWY_INLINE void LoadPlanar(const ConstPoints& in, std::size_t i, V* xyz) {
  const Tag d;
  xyz[0] = hn::LoadU(d, in.x + i);
  xyz[1] = hn::LoadU(d, in.y + i);
  xyz[2] = hn::LoadU(d, in.z + i);
}

// The first stages: lengths, then where on the table a point is.
struct Locator {
  Interleaving interleaving;
  V alpha, scale, beyond_z, beyond_r, u_max, u_blind, last_ahead, least;
  bool line_ends;
  Fitness fitness{};

  HWY_INLINE explicit Locator(const FloatTable& table)
      : alpha(Broadcast(table.alpha)), scale(Broadcast(table.scale)), beyond_z(Broadcast(table.beyond_z)),
        beyond_r(Broadcast(table.beyond_r)), u_max(Broadcast(table.u_max)), u_blind(Broadcast(table.u_blind)),
        last_ahead(Broadcast(table.last_ahead)), least(Broadcast(-1 / FloatTable::blind_radius)), line_ends(table.line_ends) {}

  template <bool fine, bool split>
  HWY_INLINE void Measure(const ConstPoints& in, std::size_t i, const Points& out, Place& place) {
    const Tag d;
    V p[3];
    if (split) {
      LoadPlanar(in, i, p);
    } else {
      interleaving.Load(in.x + 3 * i, p);
      for (int c = fine ? 0 : 2; c < 3; ++c) place.p[c] = p[c];
    }
    const V r2 = hn::MulAdd(p[0], p[0], hn::Mul(p[1], p[1])), d2 = hn::MulAdd(p[2], p[2], r2);
    const V depth = hn::Sqrt(d2), r = hn::Sqrt(r2);
    fitness.Add(p[2], r, d2);
    place.r = r;
    if (split) hn::StoreU(depth, d, out.z + i);
    else place.depth = depth;
  }

  template <bool fine, Reach reach, bool split>
  HWY_INLINE void Locate(const ConstPoints& in, std::size_t i, const Points& out, Place& place) const {
    const Tag d;
    V p[3];
    if (split) {
      LoadPlanar(in, i, p);
    } else {
      for (int c = fine ? 0 : 2; c < 3; ++c) p[c] = place.p[c];
    }
    const V r = place.r, depth = split ? hn::LoadU(d, out.z + i) : place.depth;
    if constexpr (reach == Reach::cosine) {
      place.inverse = hn::Div(scale, Divisor<reach>(p[2], p[2], r, depth));
      place.at = hn::MulAdd(p[2], place.inverse, scale);
    } else {
      const HalfAngle half(r, p[2], depth);
      const V bottom = hn::MulAdd(alpha, half.o, half.n), u = hn::Div(half.n, bottom);
      if (fine) place.finer = hn::Mul(Finer(p, r, depth, half, bottom, u, alpha), scale);
      place.at = u;
      place.inverse = hn::Div(scale, Divisor<reach>(u, p[2], r, depth));
    }
  }

  // What divides x: rho up to the rim, or r where R is tabulated; beyond the rim what the tangent extension says, negated.
  // @param at u, or z for the cosine
  template <Reach reach>
  HWY_INLINE V Divisor(V at, V z, V r, V depth) const {
    const auto is_within = [&](V limit) HWY_ATTR { return hn::Le(at, reach == Reach::cosine ? hn::Mul(limit, depth) : limit); };
    V line = hn::MulSub(beyond_z, z, hn::Mul(beyond_r, r));
    if (line_ends) line = hn::IfThenElseZero(is_within(u_blind), line);
    V measure = depth;
    if (reach == Reach::behind) measure = hn::IfThenElse(hn::Gt(PieceOf(hn::MulAdd(at, scale, Magic())), last_ahead), r, depth);
    return hn::IfThenElse(is_within(u_max), measure, LowerNumber(line, hn::Mul(least, r)));
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

// The last stage: the polynomials.
template <int pieces, int degree, bool fine, Reach reach, bool perspective, bool split>
struct Finisher {
  Interleaving interleaving;
  Coefficients<pieces, degree + 1> k, g;
  V scale, k_beyond, g_beyond;

  HWY_INLINE explicit Finisher(const FloatTable& table)
      : k(table.k), g(perspective ? table.g : table.k), scale(Broadcast(table.scale)), k_beyond(Broadcast(-1 / table.scale)),
        g_beyond(Broadcast(table.g_beyond)) {}

  HWY_INLINE void Run(const ConstPoints& in, const Place& place, std::size_t i, const Points& out) const {
    const Tag d;
    const V shifted = reach == Reach::cosine ? hn::Add(place.at, Magic()) : hn::MulAdd(place.at, scale, Magic());
    const V piece = PieceOf(shifted);
    V x = reach == Reach::cosine ? hn::Sub(place.at, piece) : hn::MulSub(place.at, scale, piece);
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

// Each stage follows the one before at a distance, so that the roots and the division of some points overlap the arithmetic
// of others.
template <int pieces, int degree, bool fine, Reach reach, bool perspective, bool split>
HWY_NOINLINE bool Map(const FloatTable& table, const ConstPoints in, const Points out) {
  Locator locator(table);
  const Finisher<pieces, degree, fine, reach, perspective, split> finisher(table);
  constexpr std::size_t ring = 16, lag = 4 * lanes;
  Place places[ring];
  const auto place = [&](std::size_t i) HWY_ATTR -> Place& { return places[i / lanes % ring]; };
  for (std::size_t i = 0; i < batch_block + 2 * lag; i += lanes) {
    if (i < batch_block) locator.template Measure<fine, split>(in, i, out, place(i));
    if (i >= lag && i < batch_block + lag) locator.template Locate<fine, reach, split>(in, i - lag, out, place(i - lag));
    if (i >= 2 * lag) finisher.Run(in, place(i - 2 * lag), i - 2 * lag, out);
  }
  return !locator.fitness.All();
}

template <int pieces, int degree, bool fine, Reach reach>
bool MapOutput(const FloatTable& table, const ConstPoints& in, const Points& out, BatchOutput output) {
  const bool split = in.stride == 1;
  if (output == BatchOutput::image)
    return split ? Map<pieces, degree, fine, reach, false, true>(table, in, out)
                 : Map<pieces, degree, fine, reach, false, false>(table, in, out);
  return split ? Map<pieces, degree, fine, reach, true, true>(table, in, out)
               : Map<pieces, degree, fine, reach, true, false>(table, in, out);
}

template <int pieces, int degree>
bool MapWith(const FloatTable& table, const ConstPoints& in, const Points& out, BatchOutput output) {
  switch (table.reach) {
  case Reach::cosine: return MapOutput<pieces, degree, false, Reach::cosine>(table, in, out, output);
  case Reach::ahead: return MapOutput<pieces, degree, false, Reach::ahead>(table, in, out, output);
  default: return MapOutput<pieces, degree, false, Reach::behind>(table, in, out, output);
  }
}

bool MapInto(const FloatTable& table, const ConstPoints& in, const Points& out, BatchOutput output) {
  if (table.fine)
    return table.reach == Reach::behind ? MapOutput<32, 7, true, Reach::behind>(table, in, out, output)
                                        : MapOutput<32, 7, true, Reach::ahead>(table, in, out, output);
  if (table.degree == 7)
    return table.pieces == 8 ? MapWith<8, 7>(table, in, out, output) : MapWith<16, 7>(table, in, out, output);
  switch (table.pieces) {
  case 8: return MapWith<8, 5>(table, in, out, output);
  case 16: return MapWith<16, 5>(table, in, out, output);
  default: return MapWith<32, 5>(table, in, out, output);
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
    const V x = hn::LoadU(d, in.x + i), y = hn::LoadU(d, in.y + i), z = hn::LoadU(d, in.z + i);
    const V r2 = hn::MulAdd(x, x, hn::Mul(y, y)), d2 = hn::MulAdd(z, z, r2);
    hn::Store(hn::IfThenElse(Fitness::Holds(Fitness::FromBehind(z, hn::Sqrt(r2)), d2), hn::Zero(d), Broadcast(1)), d, marks);
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
