// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "domewarp/convert/convert.h"
#include "domewarp/convert/display.h"
#include "domewarp/gltf/read.h"
#include "domewarp/gltf/write.h"

namespace domewarp {

/// Everything that decides what a conversion from file to file writes.
struct JobOptions {
  ReadOptions read;
  ConvertOptions convert;
  WriteOptions write;
};

/// Reads a scene, converts it and writes it. `output` appears complete or not at all.
/// @param displays shared by many jobs, or null
/// @throws Error(usage) when `output` would overwrite the input or what it refers to, Error as read_scene, convert and write_scene do
ConvertReport run_job(const std::filesystem::path& input, const std::filesystem::path& output, const JobOptions& options,
                      DisplayCache* displays = nullptr, const Progress& progress = {});

} // namespace domewarp
