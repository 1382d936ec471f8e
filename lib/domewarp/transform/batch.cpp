// SPDX-License-Identifier: Apache-2.0
#include "domewarp/transform/batch.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <limits>

#include <unistd.h>

#include "domewarp/core/parallel.h"
#include "domewarp/transform/batch_kernel.h"
#include "domewarp/transform/polar.h"

namespace domewarp {

namespace {

constexpr std::size_t block = batch_block;
constexpr std::size_t blocks_per_task = 32; // fewer points are not worth a second thread

// One block in arrays of its own.
struct Buffer {
  alignas(64) std::array<float, block> x, y, z;
  Points points() { return {x.data(), y.data(), z.data(), 1}; }
};

template <typename Any> // Points or ConstPoints
Any at(const Any& points, std::size_t i) {
  return {points.x + i * points.stride, points.y + i * points.stride, points.z + i * points.stride, points.stride};
}

void copy(const ConstPoints& in, const Points& out, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) {
    out.x[i * out.stride] = in.x[i * in.stride];
    out.y[i * out.stride] = in.y[i * in.stride];
    out.z[i * out.stride] = in.z[i * in.stride];
  }
}

// Arrays that do not fit the last cache are written past it.
bool is_streamed(std::size_t count) {
  static const long cache = sysconf(_SC_LEVEL3_CACHE_SIZE);
  constexpr std::size_t usual = 32 << 20, bytes_per_point = 6 * sizeof(float);
  return count * bytes_per_point > (cache > 0 ? static_cast<std::size_t>(cache) : usual) / 4 * 3;
}

struct Exact {
  double x, y, depth;
};

} // namespace

struct BatchMap::Impl {
  Surface surface;
  std::optional<FloatTable> table{};
  ImageMap exact{};
  BatchReport report{};

  const BranchMap& branch_of(const Vec3& p) const {
    for (const BranchMap& branch : exact.branches) {
      const Vec2 within = branch.inside(p);
      if (within.x >= 0 && within.y >= 0) return branch;
    }
    return exact.branches.back();
  }

  Exact map_exactly(const Vec3& p) const {
    const ImagePoint point = project(surface, exact, p);
    const bool has_direction = std::isfinite(point.depth) && point.depth > 0;
    if (!has_direction) return {point.x, point.y, std::numeric_limits<double>::quiet_NaN()};
    Vec2 image(point.x, point.y);
    const double radius = point.state == PointState::blind ? 0 : std::hypot(image.x, image.y);
    if (point.state == PointState::blind || radius > FloatTable::blind_radius) image = static_cast<double>(FloatTable::blind_radius) * side(polar(p));
    return {image.x, image.y, point.depth};
  }

  void map_one(const ConstPoints& in, const Points& out, std::size_t i, BatchOutput output) const {
    const std::size_t from = i * in.stride, to = i * out.stride;
    const Vec3 p(in.x[from], in.y[from], in.z[from]);
    const Exact point = map_exactly(p);
    const double w = output == BatchOutput::image ? 1 : point.depth * branch_of(p).factors(p).g;
    out.x[to] = static_cast<float>(w * point.x);
    out.y[to] = static_cast<float>(w * point.y);
    out.z[to] = static_cast<float>(output == BatchOutput::image ? point.depth : -w);
  }

  /// The points of a block that single precision cannot do: a power of two brings most of them into its range, and the
  /// others are done in double.
  void repair(const ConstPoints& in, const Points& out, std::size_t count, BatchOutput output) const {
    Buffer source, scaled, mapped;
    std::array<float, block> factor;
    std::array<std::uint8_t, block> unfit, hopeless;
    fill(in, source, count);
    find_unfit(source.points(), unfit.data());
    for (std::size_t i = 0; i < block; ++i) {
      const float size = std::max({std::abs(source.x[i]), std::abs(source.y[i]), std::abs(source.z[i])});
      factor[i] = !unfit[i] ? 1.0F : size < 1 ? 0x1p90F : 0x1p-78F;
      scaled.x[i] = source.x[i] * factor[i];
      scaled.y[i] = source.y[i] * factor[i];
      scaled.z[i] = source.z[i] * factor[i];
    }
    map_block(*table, scaled.points(), mapped.points(), output, false);
    find_unfit(scaled.points(), hopeless.data());
    for (std::size_t i = 0; i < count; ++i) {
      if (!unfit[i]) continue;
      if (hopeless[i]) {
        map_one(in, out, i, output);
        continue;
      }
      const float image_factor = output == BatchOutput::image ? 1.0F : 1 / factor[i];
      out.x[i * out.stride] = mapped.x[i] * image_factor;
      out.y[i * out.stride] = mapped.y[i] * image_factor;
      out.z[i * out.stride] = mapped.z[i] * (1 / factor[i]);
    }
  }

  /// Copies `count` points and fills up with points straight ahead.
  static void fill(const ConstPoints& in, Buffer& buffer, std::size_t count) {
    buffer.x.fill(0);
    buffer.y.fill(0);
    buffer.z.fill(-1);
    copy(in, buffer.points(), count);
  }

  void map_part(const ConstPoints& in, const Points& out, std::size_t count, BatchOutput output) const {
    Buffer source, mapped;
    fill(in, source, count);
    const bool unfit = map_block(*table, source.points(), mapped.points(), output, false);
    copy(mapped.points(), out, count);
    if (unfit) repair(in, out, count, output);
  }

  /// The kernel knows points that are laid out alike.
  bool map_whole(const ConstPoints& in, const Points& out, BatchOutput output, bool streams) const {
    if (in.stride == out.stride) return map_block(*table, in, out, output, streams);
    Buffer source, mapped;
    if (in.stride != 1) copy(in, source.points(), block);
    const bool unfit = map_block(*table, in.stride == 1 ? in : source.points(), mapped.points(), output, false);
    copy(mapped.points(), out, block);
    return unfit;
  }

  void map_blocks(const ConstPoints& in, const Points& out, std::size_t count, BatchOutput output) const {
    const bool streams = is_streamed(count);
    const std::size_t whole = count / block;
    parallel_ranges(whole, blocks_per_task, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const ConstPoints from = at(in, i * block);
        const Points to = at(out, i * block);
        if (map_whole(from, to, output, streams)) repair(from, to, block, output);
      }
      if (streams) finish_streaming();
    });
    const std::size_t done = whole * block;
    if (done < count) map_part(at(in, done), at(out, done), count - done, output);
  }
};

BatchMap::BatchMap(const Surface& surface, const BatchOptions& options) {
  const auto start = std::chrono::steady_clock::now();
  auto impl = std::make_unique<Impl>(Impl{surface});
  const bool few = options.method == Method::automatic && options.points < float_table_pays_from;
  const bool direct = options.method == Method::direct || few;
  std::optional<FloatFit> fit;
  if (!direct) fit = make_float_table(surface, options.max_error);
  impl->exact = make_image_map(surface, fit ? Method::direct : options.method, options.points);
  for (const BranchMap& branch : impl->exact.branches)
    if (!fit && !branch.table().used) impl->report = {false, true, branch.table().reason};
  if (fit) {
    impl->table = fit->table;
    impl->report = {true, false, TableReason::used, fit->table.pieces, fit->table.degree, fit->predicted_error, fit->weight_error, 0};
  }
  const std::chrono::duration<double, std::milli> elapsed = std::chrono::steady_clock::now() - start;
  impl->report.build_ms = elapsed.count();
  impl_ = std::move(impl);
}

BatchMap::~BatchMap() = default;
BatchMap::BatchMap(BatchMap&&) noexcept = default;
BatchMap& BatchMap::operator=(BatchMap&&) noexcept = default;

const BatchReport& BatchMap::report() const { return impl_->report; }

void BatchMap::map(const ConstPoints& in, const Points& out, std::size_t count, BatchOutput output) const {
  if (impl_->table) return impl_->map_blocks(in, out, count, output);
  constexpr std::size_t grain = 1024;
  parallel_each(count, grain, [&](std::size_t i) { impl_->map_one(in, out, i, output); });
}

} // namespace domewarp
