// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "domewarp/convert/job.h"

namespace domewarp {

/// A long option of `domewarp convert` without its dashes, its argument (nothing for a flag), and where it was given, for
/// messages ("jobs.json:4:7: scenes[2].tolerance").
struct JobArgument {
  std::string name;
  std::optional<std::string> value;
  std::string where;
};

/// Turns arguments into options: what the command line does with them. @throws Error(usage, input)
using ParseArguments = std::function<JobOptions(const std::vector<JobArgument>&)>;

/// One scene of a batch.
struct BatchItem {
  std::filesystem::path input;
  std::filesystem::path output;        ///< relative to the output folder, no ".."
  std::string arguments;               ///< canonical text of the options, equal for equal options
  std::shared_ptr<const JobOptions> options; ///< shared by scenes with equal arguments
};

struct PlanOptions {
  std::filesystem::path out;           ///< the output folder; files in it are no inputs
  std::string extension = ".glb";      ///< of outputs that no manifest names: .glb or .gltf
  std::vector<JobArgument> arguments;  ///< for every scene, unless a manifest says otherwise
  ParseArguments parse;
};

/// The scenes that the inputs stand for, ordered by output. An input is a scene file, a folder (its .glb and .gltf files at
/// any depth, in folders of the same names; hidden files and folders and output folders of batches are left out, symbolic links to
/// folders are not followed), or a manifest (.json). A
/// manifest's defaults overrule `arguments`, a scene's options its defaults; a curve, lens or profile takes the place of
/// another, and so do target and forward, eye and camera. Outputs that would have one name get the input's
/// extension into it (a_gltf.glb). A .gltf output has a folder of its own.
/// @throws Error(input) for a manifest that cannot be read or has a bad option (with line, column and key), a folder
///         that cannot be read, outputs of a manifest that collide or leave the output folder, no scene at all;
///         Error(usage) for bad `arguments`, an output that is an input
std::vector<BatchItem> plan_batch(const std::vector<std::string>& inputs, const PlanOptions& options);

/// Every count-th item from the index-th (from 1).
std::vector<BatchItem> shard(const std::vector<BatchItem>& items, std::size_t index, std::size_t count);

} // namespace domewarp
