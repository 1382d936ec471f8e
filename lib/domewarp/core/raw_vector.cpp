// SPDX-License-Identifier: Apache-2.0
#include "domewarp/core/raw_vector.h"

#include <cstdint>
#include <limits>

#include <sys/mman.h>

namespace domewarp {

namespace {

constexpr std::size_t huge_page = std::size_t(2) << 20, page = 4096;

std::size_t round_up(std::size_t bytes, std::size_t to) { return (bytes + to - 1) / to * to; }

/// Whole pages at a multiple of a huge one.
void* map_aligned(std::size_t bytes) {
  const std::size_t size = bytes + huge_page;
  void* const mapped = mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (mapped == MAP_FAILED) throw std::bad_alloc();
  const auto address = reinterpret_cast<std::uintptr_t>(mapped);
  const std::size_t before = round_up(address, huge_page) - address, after = huge_page - before;
  if (before > 0) munmap(mapped, before);
  if (after > 0) munmap(static_cast<char*>(mapped) + before + bytes, after);
  return static_cast<char*>(mapped) + before;
}

} // namespace

void* allocate_raw(std::size_t bytes) {
  if (bytes < huge_page) return ::operator new(bytes);
  if (bytes > std::numeric_limits<std::size_t>::max() - 2 * huge_page) throw std::bad_alloc();
  void* const block = map_aligned(round_up(bytes, page));
  // Whole huge pages only: the rest of the last one would be memory that nobody asked for. A refusal costs time alone.
  madvise(block, bytes / huge_page * huge_page, MADV_HUGEPAGE);
  return block;
}

void free_raw(void* block, std::size_t bytes) noexcept {
  if (bytes < huge_page)
    ::operator delete(block);
  else
    munmap(block, round_up(bytes, page));
}

} // namespace domewarp
