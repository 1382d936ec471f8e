// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <new>
#include <type_traits>
#include <utility>
#include <vector>

namespace domewarp {

/// Unset memory. Large blocks come from the kernel and go back to it, so that they never lie between others, and ask for
/// huge pages: a page costs more to get than most passes need to fill it (47,000 of them were 30 % of the time to convert
/// 10^6 triangles).
/// @return never null; @throws std::bad_alloc
void* allocate_raw(std::size_t bytes);

/// @param bytes as asked for
void free_raw(void* block, std::size_t bytes) noexcept;

/// Leaves new elements unset, so that the threads that fill an array are the first to touch its memory.
template <typename T>
struct RawAllocator : std::allocator<T> {
  static_assert(std::is_trivially_copyable_v<T> && std::is_trivially_destructible_v<T>);
  template <typename U>
  struct rebind {
    using other = RawAllocator<U>;
  };
  RawAllocator() = default;
  template <typename U>
  RawAllocator(const RawAllocator<U>&) {}
  T* allocate(std::size_t count) {
    if (count > static_cast<std::size_t>(-1) / sizeof(T)) throw std::bad_array_new_length();
    return static_cast<T*>(allocate_raw(count * sizeof(T)));
  }
  void deallocate(T* block, std::size_t count) noexcept { free_raw(block, count * sizeof(T)); }
  template <typename U>
  void construct(U*) {}
  template <typename U, typename... Arguments>
  void construct(U* at, Arguments&&... arguments) {
    std::construct_at(at, std::forward<Arguments>(arguments)...);
  }
};

/// A vector whose resize() leaves what it adds unset.
template <typename T>
using RawVector = std::vector<T, RawAllocator<T>>;

} // namespace domewarp
