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

/// Keeps freed memory for what comes next instead of giving it back at once: getting it anew costs a conversion a tenth of
/// its time. For programs; called once, before threads are started.
void keep_free_memory();

/// Gives memory that was freed back to the system.
void release_free_memory();

/// Gives a vector's memory back; `vector = {}` and clear() keep it.
template <typename Vector>
void free_vector(Vector& vector) {
  Vector().swap(vector);
}

} // namespace domewarp
