// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <iostream>
#include <memory>
#include <string>

#include <CLI/CLI.hpp>

#include "commands.h"
#include "domewarp/core/errors.h"
#include "domewarp/core/files.h"
#include "domewarp/gltf/write.h"
#include "domewarp/scene/test_scenes.h"

namespace domewarp {

namespace {

int run(const std::filesystem::path& folder) {
  if (folder.empty()) throw Error(ErrorCode::usage, "--out: is empty");
  make_folder(folder);
  for (const TestScene& test : make_test_scenes()) {
    const std::filesystem::path file = folder / (test.name + ".glb");
    write_scene(test.scene, file);
    std::cout << file.string() << ": " << test.scene.instances.size() << " objects, " << count_triangles(test.scene) << " triangles\n";
  }
  return 0;
}

} // namespace

void add_scenes_command(CLI::App& app, int& status) {
  auto* command = app.add_subcommand("scenes", "Write the five bundled test scenes.");
  auto folder = std::make_shared<std::string>();
  command->add_option("--out", *folder, "Folder to write to")->required()->type_name("DIR");
  command->callback([folder, &status] { status = run(*folder); });
}

} // namespace domewarp
