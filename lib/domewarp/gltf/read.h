// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

#include "domewarp/scene/scene.h"

namespace domewarp {

struct ReadOptions {
  std::string scene{};         ///< name or index of the scene to read, empty for the file's default scene
  std::string animation{};     ///< name or index of the animation to pose the scene with, empty for the rest pose
  double time = 0;             ///< seconds, of `animation`
  bool allow_external = false; ///< allow URIs that leave the folder of the file
  std::size_t max_bytes = std::size_t(4) << 30; ///< refuse files that ask for more memory than this
};

/// Reads a .glb or .gltf file (told apart by content) and flattens it to what its scene draws: nodes with their world
/// matrices, strips, fans and loops as lists, compressed and quantised data as floats, skins and morph targets posed
/// at rest or at a time of an animation. Instances whose matrix mirrors get a mesh of their own with the winding swapped, so that triangles are
/// counter-clockwise seen from outside in world space. Skinned instances have world-space positions and the identity.
/// @return Scene::warnings names the defects that do no harm. A missing or broken image has empty `bytes`.
/// @throws Error(input) with the file, the place and the defect when the file cannot be read, is invalid, refers to
/// files outside its folder (unless `allow_external`), requires an extension that is not supported or needs more
/// memory than `max_bytes`; Error(usage) when it has no scene
/// `options.scene` or no animation `options.animation`.
Scene read_scene(const std::filesystem::path& path, const ReadOptions& options = {});

} // namespace domewarp
