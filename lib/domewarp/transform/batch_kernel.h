// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

#include "domewarp/transform/batch.h"
#include "domewarp/transform/float_table.h"

namespace domewarp {

/// Points that the kernel takes at a time: what it keeps between its two stages fits the L1 cache.
inline constexpr std::size_t batch_block = 1024;

/// Maps a whole block; see BatchMap::map. Picks the widest instruction set at run time; those with fused
/// multiply-add (AVX2, AVX-512) give the same bits.
/// @param in, out `batch_block` points each, laid out alike: in.stride == out.stride
/// @param streams writes past the caches
/// @return whether some points are outside the range of single precision: their results are meaningless, and
///         `find_unfit` tells which they are
bool map_block(const FloatTable& table, const ConstPoints& in, const Points& out, BatchOutput output, bool streams);

/// flags[i] = 1 for the points of a block that `map_block` cannot do.
void find_unfit(const ConstPoints& in, std::uint8_t* flags);

/// Makes what `map_block` streamed visible to other threads.
void finish_streaming();

} // namespace domewarp
