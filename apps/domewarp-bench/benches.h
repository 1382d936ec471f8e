// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "chart.h"

namespace domewarp::bench {

struct Options {
  bool quick = false; ///< smoke test: every row, on data too small to mean anything
  /// Says on a terminal what is being measured.
  std::function<void(const std::string&)> progress = [](const std::string&) {};
};

/// What a bench found: printed, and written as CSV and SVG, by main.
struct Result {
  std::vector<Table> tables;
  std::vector<Plot> plots;
  std::vector<std::string> notes; ///< sentences under the tables: ratios reached, what was left out
};

/// One function per subcommand, each in the file of its name.
Result run_convert_bench(const Options& options);
Result run_live_bench(const Options& options);
Result run_map_bench(const Options& options);
Result run_mesh_bench(const Options& options);
Result run_render_bench(const Options& options);
Result run_thesis_bench(const Options& options);

struct Bench {
  const char* name;
  const char* description;
  Result (*run)(const Options&);
};

/// The subcommands. A new bench is a declaration above, a line here and its file in CMakeLists.txt.
inline constexpr Bench benches[] = {
    {"convert", "Whole conversions of 10^3 to 10^7 triangles: time and memory against reading and writing alone.", run_convert_bench},
    {"live", "Frames per second of warping all vertices for a moving eye, and how far it may move before refining again.", run_live_bench},
    {"map", "Batches of points: time per vertex against error, beside a copy of the same bytes.", run_map_bench},
    {"mesh", "Refinement: triangles against goals, rivals and a lower bound, true against certified error, speed, growth, what skipping saves.", run_mesh_bench},
    {"render", "Both renderers: time and memory against pixels; primary rays per second beside Embree's own on the same rays.", run_render_bench},
    {"thesis", "Tables 2 and 3, Figures 25 and 26 of the thesis: frames per second and points, beside its figures.", run_thesis_bench},
};

} // namespace domewarp::bench
