// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <string>
#include <utility>

#include <hwy/targets.h>
#if defined(__SSE2__)
#include <emmintrin.h>
#endif

#include "benches.h"
#include "domewarp/core/parallel.h"
#include "domewarp/transform/batch.h"
#include "map_floor.h"
#include "map_tables.h"
#include "thesis_methods.h"
#include "timing.h"

namespace domewarp::bench {

namespace {

constexpr double nothing = std::numeric_limits<double>::quiet_NaN();

struct Cloud {
  std::vector<float> values;
  std::size_t count() const { return values.size() / 3; }
  Points split() { return {values.data(), values.data() + count(), values.data() + 2 * count(), 1}; }
  Points mixed() { return interleaved(values.data()); }
};

Cloud random_directions(std::size_t count) {
  std::mt19937 random(1);
  std::normal_distribution<float> normal;
  Cloud cloud{std::vector<float>(3 * count)};
  for (float& value : cloud.values) value = normal(random);
  return cloud;
}

void copy(const std::vector<float>& in, std::vector<float>& out) {
  for (std::size_t i = 0; i < in.size(); ++i) out[i] = 1.5F * in[i];
}

// Past the caches, as the kernel writes large arrays.
void copy_streaming(const std::vector<float>& in, std::vector<float>& out) {
#if defined(__SSE2__)
  std::size_t i = 0;
  for (; reinterpret_cast<std::uintptr_t>(&out[i]) % 16 != 0; ++i) out[i] = 1.5F * in[i];
  const __m128 factor = _mm_set1_ps(1.5F);
  for (; i + 4 <= in.size(); i += 4) _mm_stream_ps(&out[i], _mm_mul_ps(factor, _mm_loadu_ps(&in[i])));
  for (; i < in.size(); ++i) out[i] = 1.5F * in[i];
  _mm_sfence();
#else
  copy(in, out);
#endif
}

struct Error {
  double most = 0, rms = 0;
};

// Of the visible ones among the first points, against the direct method in double precision.
Error measure(const Surface& surface, const Cloud& in, const Cloud& out, bool is_split) {
  constexpr std::size_t enough = 20000;
  const ImageMap exact = make_image_map(surface, Method::direct);
  const std::size_t count = in.count(), stride = is_split ? 1 : 3, next = is_split ? count : 1;
  Error error;
  std::size_t visible = 0;
  for (std::size_t i = 0; i < std::min(count, enough); ++i) {
    const std::size_t at = i * stride;
    const ImagePoint point = project(surface, exact, {in.values[at], in.values[at + next], in.values[at + 2 * next]});
    if (point.state != PointState::visible) continue;
    const double off = std::hypot(out.values[at] - point.x, out.values[at + next] - point.y);
    error = {std::max(error.most, off), error.rms + off * off};
    ++visible;
  }
  error.rms = std::sqrt(error.rms / static_cast<double>(std::max<std::size_t>(visible, 1)));
  return error;
}

struct Way {
  std::string name;
  double table_size = nothing; ///< bytes
  std::function<void()> work;
  bool is_split = true;
  bool has_error = true;
  std::int64_t targets = 0; ///< of Highway; 0: all
};

std::function<void()> batch_work(const BatchMap& map, Cloud& in, Cloud& out, bool split, BatchOutput output) {
  return [&map, &in, &out, split, output] {
    map.map(split ? in.split() : in.mixed(), split ? out.split() : out.mixed(), in.count(), output);
  };
}

void add_batches(std::vector<Way>& ways, const BatchMap& map, Cloud& in, Cloud& out) {
  if (!map.report().vectorised) return;
  const double bytes = map.report().pieces * (map.report().degree + 1) * 4.0;
  std::vector<std::pair<std::string, std::int64_t>> sets;
  if (hwy::SupportedTargets() & HWY_AVX3) sets.emplace_back("AVX-512", HWY_AVX3);
  if (hwy::SupportedTargets() & HWY_AVX2) sets.emplace_back("AVX2", HWY_AVX2);
  if (sets.empty()) sets.emplace_back("widest", 0);
  for (const auto& [name, targets] : sets) {
    const auto floor = [&in, &out] { map_floor(in.split(), out.split(), in.count()); };
    ways.push_back({"floor: two roots, a division, " + name, 0, floor, true, false, targets});
    ways.push_back({"float table, " + name, bytes, batch_work(map, in, out, true, BatchOutput::image), true, true, targets});
    ways.push_back({"float table, interleaved, " + name, bytes, batch_work(map, in, out, false, BatchOutput::image), false, true, targets});
    ways.push_back({"float table, perspective, " + name, 2 * bytes, batch_work(map, in, out, true, BatchOutput::perspective), true, false, targets});
  }
}

// Slow ways are timed on fewer points.
void add_slow(std::vector<Way>& ways, const Curve& curve, const ThesisTable& table, double r_max, const BatchMap& exact_table,
              const BatchMap& direct, Cloud& in, Cloud& out) {
  ways.push_back({"double table", nothing, batch_work(exact_table, in, out, true, BatchOutput::image)});
  ways.push_back({"direct", 0, batch_work(direct, in, out, true, BatchOutput::image)});
  ways.push_back({"thesis table", 4.0 * static_cast<double>(table.radii.size()), [&] { map_by_thesis_table(table, in.split(), out.split(), in.count()); }});
  ways.push_back({"thesis bisection", 0, [&, r_max] { map_by_bisection(curve, r_max, in.split(), out.split(), in.count()); }});
}

// Asks the CPU what it has here, which takes long, and not in what is timed.
void choose(std::int64_t targets) {
  hwy::SetSupportedTargetsForTest(targets);
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
}

// The least processor time of each way per point, in rounds in which all take turns.
std::vector<double> time_ways(const std::vector<Way>& ways, const Cloud& in, int rounds) {
  std::vector<double> least(ways.size(), std::numeric_limits<double>::infinity());
  for (int round = 0; round < rounds; ++round)
    for (std::size_t i = 0; i < ways.size(); ++i) {
      choose(ways[i].targets);
      least[i] = std::min(least[i], processor_seconds(ways[i].work));
    }
  choose(0);
  for (double& time : least) time *= 1e9 / static_cast<double>(in.count());
  return least;
}

struct Row {
  std::string curve;
  double r_max, points;
  std::string method;
  double table_size, ns, ratio;
  Error error;
  bool is_front = false; ///< no other method of the group is both faster and more exact
};

std::vector<Row> measure_ways(const Surface& surface, const std::vector<Way>& ways, const Cloud& in, Cloud& out, double copy_ns, int rounds) {
  std::vector<Row> rows;
  const std::vector<double> times = time_ways(ways, in, rounds);
  for (std::size_t i = 0; i < ways.size(); ++i) {
    Error error{nothing, nothing};
    if (ways[i].has_error) {
      choose(ways[i].targets);
      ways[i].work();
      error = measure(surface, in, out, ways[i].is_split);
    }
    rows.push_back({surface.options().curve, surface.r_max(), static_cast<double>(in.count()), ways[i].name, ways[i].table_size, times[i], times[i] / copy_ns, error});
  }
  choose(0);
  return rows;
}

/// The Pareto front of a group: rows of one curve, r_max and number of points.
void mark_front(std::vector<Row>& group) {
  const auto beats = [](const Row& a, const Row& b) {
    return a.ns <= b.ns && a.error.most <= b.error.most && (a.ns < b.ns || a.error.most < b.error.most);
  };
  for (Row& row : group)
    row.is_front = std::isfinite(row.error.most) && std::ranges::none_of(group, [&](const Row& other) { return beats(other, row); });
}

void measure_curve(const std::string& text, double r_max, std::size_t count, int rounds, std::vector<Row>& rows) {
  SurfaceOptions options;
  options.curve = text;
  const Surface surface(options, r_max);
  const Curve curve = make_curve(text);
  BatchOptions exactly, directly;
  exactly.max_error = 0; // no float table is that exact
  directly.method = Method::direct;
  const BatchMap map(surface), exact_table(surface, exactly), direct(surface, directly);
  const ThesisTable thesis = make_thesis_table(curve, surface.r_max());

  Cloud in = random_directions(count), out = in;
  std::vector<Way> ways{{"copy", 0, [&] { copy(in.values, out.values); }, true, false},
                        {"copy, streaming", 0, [&] { copy_streaming(in.values, out.values); }, true, false}};
  add_batches(ways, map, in, out);
  std::vector<Row> group = measure_ways(surface, ways, in, out, 1, rounds);
  const double copy_ns = std::min(group[0].ns, group[1].ns);
  for (Row& row : group) row.ratio = row.ns / copy_ns;

  Cloud few = random_directions(std::max<std::size_t>(count / 100, 1000)), few_out = few;
  std::vector<Way> slow;
  add_slow(slow, curve, thesis, surface.r_max(), exact_table, direct, few, few_out);
  const std::vector<Row> more = measure_ways(surface, slow, few, few_out, copy_ns, std::min(rounds, 3));
  group.insert(group.end(), more.begin(), more.end());
  mark_front(group);
  rows.insert(rows.end(), group.begin(), group.end());
}

Table tabulate(const std::vector<Row>& rows) {
  Table table{"map",
              "The map on one thread, random directions, processor time; ratio to the faster copy with one multiplication; * no other method is both faster and more exact",
              {{"curve", "curve"}, {"r_max", "r_max"}, {"points", "points"}, {"method", "method"}, {"table_bytes", "table (B)"},
               {"ns_per_vertex", "ns/vertex"}, {"ratio_to_copy", "ratio to copy"}, {"max_error", "max error"},
               {"rms_error", "RMS error"}, {"px_4096", "max px at 4096"}, {"px_8192", "max px at 8192"}, {"pareto", "Pareto"}},
              {}};
  for (const Row& row : rows)
    table.rows.push_back({row.curve, row.r_max, row.points, row.method, row.table_size, row.ns, row.ratio, row.error.most, row.error.rms,
                          2048 * row.error.most, 4096 * row.error.most, std::string(row.is_front ? "*" : "")});
  return table;
}

/// The fastest method of the product beside those of the thesis, on the same data.
Table compare_with_thesis(const std::vector<Row>& rows) {
  Table table{"map_thesis",
              "The fastest method of each group against the thesis' methods",
              {{"curve", "curve"}, {"r_max", "r_max"}, {"points", "points"}, {"method", "method"}, {"table_speedup", "times its table's speed"},
               {"bisection_speedup", "times its bisection's speed"}, {"table_accuracy", "times its table's accuracy"}},
              {}};
  const Row* best = nullptr;
  const Row* thesis_table = nullptr;
  for (const Row& row : rows) {
    if (row.method == "copy") best = nullptr; // a new group
    const bool is_ours = std::isfinite(row.error.most) && !row.method.starts_with("thesis");
    if (is_ours && (best == nullptr || row.ns < best->ns)) best = &row;
    if (row.method == "thesis table") thesis_table = &row;
    if (row.method != "thesis bisection" || best == nullptr || thesis_table == nullptr) continue;
    table.rows.push_back({row.curve, row.r_max, best->points, best->method, thesis_table->ns / best->ns, row.ns / best->ns,
                          thesis_table->error.most / best->error.most});
  }
  return table;
}

Plot draw(const std::vector<Row>& rows) {
  Plot plot{"map", "Time against error (" + rows.front().curve + ")", {"time per vertex (ns)", true}, {"largest error (image units)", true}, {}};
  Series front{"Pareto front", {}};
  for (const Row& row : rows) {
    const auto is_drawn = [&](const Series& series) { return series.name == row.method; };
    if (row.curve != rows.front().curve || !std::isfinite(row.error.most) || std::ranges::any_of(plot.series, is_drawn)) continue;
    plot.series.push_back({row.method, {{row.ns, row.error.most}}, false});
    if (row.is_front) front.points.emplace_back(row.ns, row.error.most);
  }
  std::ranges::sort(front.points, {}, &Vec2::x);
  plot.series.insert(plot.series.begin(), front); // the methods' markers are drawn over it
  return plot;
}

} // namespace

Result run_map_bench(const Options& options) {
  const ThreadLimit one(1);
  std::vector<Row> rows;
  const std::vector<std::size_t> counts = options.quick ? std::vector<std::size_t>{2000} : std::vector<std::size_t>{1'000'000, 10'000'000};
  for (const char* curve : {"1-r^2", "3-sqrt(4+6*r^2)", "-log(r+0.1)"})
    for (const double r_max : {1.0, 5.0 / 3})
      for (const std::size_t count : counts) {
        options.progress(std::string(curve) + ", " + std::to_string(count) + " points");
        measure_curve(curve, r_max, count, options.quick ? 1 : count > 5'000'000 ? 9 : 30, rows);
      }
  return {{tabulate(rows), compare_with_thesis(rows), float_tables(options), double_tables(options)},
          {draw(rows)},
          {"Slow methods are timed on a hundredth of the points.",
           "The floor reads, takes the roots and the division that every such map takes, and writes; it does not write past the caches.",
           "--method auto builds tables from " + std::to_string(table_pays_from) + " points on, tables in single precision from " +
               std::to_string(float_table_pays_from) + " on."}};
}

} // namespace domewarp::bench
