// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include <gtest/gtest.h>

#include "domewarp/core/errors.h"
#include "domewarp/gltf/write.h"
#include "gltf_file.h"

namespace domewarp::test {
namespace {

namespace fs = std::filesystem;

std::vector<fs::path> files_in(const char* folder) {
  std::vector<fs::path> files;
  std::error_code status;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(fs::path(DOMEWARP_ASSETS) / folder, status))
    if (entry.path().extension() == ".glb" || entry.path().extension() == ".gltf") files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

/// Every number of a scene that a file can hold.
void expect_equal(const Scene& a, const Scene& b, const fs::path& file) {
  ASSERT_EQ(a.instances.size(), b.instances.size()) << file;
  EXPECT_EQ(count_triangles(a), count_triangles(b)) << file;
  EXPECT_EQ(a.cameras.size(), b.cameras.size()) << file;
  EXPECT_EQ(a.lights.size(), b.lights.size()) << file;
  for (std::size_t i = 0; i < a.instances.size(); ++i) {
    const Mesh &x = a.meshes[static_cast<std::size_t>(a.instances[i].mesh)],
               &y = b.meshes[static_cast<std::size_t>(b.instances[i].mesh)];
    ASSERT_EQ(x.primitives.size(), y.primitives.size()) << file;
    for (int c = 0; c < 4; ++c)
      for (int r = 0; r < 4; ++r)
        ASSERT_NEAR(a.instances[i].world[c][r], b.instances[i].world[c][r],
                    1e-12 * (1 + std::abs(a.instances[i].world[c][r])))
            << file;
    if (i > 50) continue; // 2500 instances of one mesh
    for (std::size_t k = 0; k < x.primitives.size(); ++k) {
      EXPECT_EQ(x.primitives[k].positions, y.primitives[k].positions) << file;
      EXPECT_EQ(x.primitives[k].indices, y.primitives[k].indices) << file;
      for (const Attribute& attribute : x.primitives[k].attributes) {
        const Attribute* other = find_attribute(y.primitives[k], attribute.name);
        if (other)
          EXPECT_EQ(attribute.values, other->values) << file << " " << attribute.name;
        else
          EXPECT_EQ(attribute.name, "TANGENT") << file;
      }
    }
  }
}

TEST(Assets, ReadAndWriteBackWithoutLoss) {
  const TemporaryFolder folder;
  std::size_t count = 0;
  for (const char* kind : {"scenes", "features", "odd"})
    for (const fs::path& file : files_in(kind)) {
      const Scene scene = read_scene(file);
      for (const std::string extension : {"glb", "gltf"}) {
        const fs::path out = folder / (std::to_string(count) + "/out." + extension);
        fs::create_directories(out.parent_path());
        write_scene(scene, out);
        const Scene again = read_scene(out);
        expect_equal(scene, again, file);
        EXPECT_TRUE(again.warnings.empty()) << file << ": " << again.warnings.front();
      }
      ++count;
    }
  if (count == 0) GTEST_SKIP() << "the sample scenes are not here";
}

TEST(Assets, GoodFilesGiveNoFalseAlarm) {
  for (const char* kind : {"scenes", "features"})
    for (const fs::path& file : files_in(kind)) {
      const Scene scene = read_scene(file);
      EXPECT_TRUE(scene.warnings.empty()) << file << ": " << scene.warnings.front();
      EXPECT_FALSE(scene.instances.empty()) << file;
    }
}

TEST(Assets, BadFilesAreRefusedOrReadWithAWarning) {
  for (const fs::path& file : files_in("bad")) {
    try {
      const Scene scene = read_scene(file);
      EXPECT_FALSE(scene.warnings.empty()) << file;
      EXPECT_NO_THROW(encode_glb(scene)) << file;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::input) << file;
      EXPECT_TRUE(std::string(error.what()).starts_with(file.string())) << error.what();
    }
  }
}

} // namespace
} // namespace domewarp::test
