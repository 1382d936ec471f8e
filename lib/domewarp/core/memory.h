// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace domewarp {

/// The most physical memory this process has used so far, bytes.
std::uint64_t peak_memory();

/// From now on the process gets no more than this many bytes of data memory: allocations beyond throw std::bad_alloc
/// instead of letting the kernel choose whom to kill. Memory that is mapped from files does not count.
/// @throws Error(usage) when the process has more than that already or the system refuses
void limit_memory(std::uint64_t bytes);

/// Gives memory that was freed back to the system.
void release_free_memory();

} // namespace domewarp
