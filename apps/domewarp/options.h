// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "domewarp/convert/job.h"

namespace CLI {
class App;
class Option;
}

namespace domewarp {

/// A finite number, the whole text. @throws Error(usage) naming the option and the text.
double parse_number(const std::string& option, const std::string& text);

/// The same, > 0.
double parse_positive(const std::string& option, const std::string& text);

/// A whole number >= 0. @throws Error(usage)
std::size_t parse_count(const std::string& option, const std::string& text);

/// MiB, at least 1, as bytes. @throws Error(usage)
std::uint64_t parse_memory(const std::string& option, const std::string& text);

/// "X,Y,Z". @throws Error(usage)
Vec3 parse_vector(const std::string& option, const std::string& text);

/// Each adds a group of options that several commands share. Bad values throw Error(usage) while the line is parsed.
void add_read_options(CLI::App& app, ReadOptions& read);
void add_pose_options(CLI::App& app, ReadOptions& read); ///< those of the above without --scene
void add_view_options(CLI::App& app, ViewOptions& view);
void add_surface_options(CLI::App& app, SurfaceOptions& surface);
void add_raster_options(CLI::App& app, Raster& raster);
void add_method_option(CLI::App& app, Method& method);
void add_quality_options(CLI::App& app, RefineOptions& refine);
void add_output_options(CLI::App& app, ConvertOptions& options);

void add_bake_options(CLI::App& app, BakeOptions& bake);

/// All options of a conversion from file to file: those of `convert`, of `batch` and of a manifest.
void add_job_options(CLI::App& app, JobOptions& job);

void add_threads_option(CLI::App& app, int& threads); ///< 0: all

/// Options of an app and of its groups.
std::vector<const CLI::Option*> all_options(const CLI::App& app);

/// @throws Error(usage) unless exactly one of --curve, --lens and --profile was given
void require_surface(const SurfaceOptions& surface);

} // namespace domewarp
