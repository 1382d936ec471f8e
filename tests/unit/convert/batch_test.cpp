// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "domewarp/convert/batch.h"
#include "domewarp/convert/batch_summary.h"
#include "domewarp/convert/fingerprint.h"
#include "domewarp/convert/stamp.h"
#include "domewarp/core/files.h"
#include "domewarp/gltf/write.h"
#include "job_arguments.h"

namespace domewarp {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;

Scene square(double depth) {
  Scene scene;
  Primitive primitive;
  primitive.positions = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
  for (Vec3f& p : primitive.positions) p.z = static_cast<float>(-depth);
  primitive.indices = {0, 1, 2, 0, 2, 3};
  scene.meshes.push_back({"square", {primitive}});
  scene.instances.push_back({"square", 0, Mat4(1)});
  return scene;
}

class BatchRun : public testing::Test {
protected:
  BatchRun() {
    folder_ = fs::path(testing::TempDir()) / ("batch_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
    fs::remove_all(folder_);
    fs::create_directories(folder_ / "in/sub");
    write_scene(square(2), folder_ / "in/a.glb");
    write_scene(square(3), folder_ / "in/sub/b.gltf");
    batch_.out = folder_ / "out";
    batch_.jobs = 2;
  }
  ~BatchRun() override { fs::remove_all(folder_); }

  BatchReport run(std::vector<JobArgument> arguments = {}) {
    arguments.insert(arguments.end(), {{"lens", "equidistant", "--lens"}, {"size", "512x512", "--size"}, {"eye", "0,0,0", "--eye"}});
    const PlanOptions plan{batch_.out, ".glb", arguments, parse_arguments};
    return run_batch(plan_batch({(folder_ / "in").string()}, plan), batch_, {});
  }

  std::vector<std::string> states(const BatchReport& report) {
    std::vector<std::string> words;
    for (const BatchRow& row : report.rows) words.push_back(row.up_to_date ? "up to date" : to_string(row.status));
    return words;
  }

  fs::path folder_;
  BatchOptions batch_;
};

TEST_F(BatchRun, ConvertsEverythingAndThenNothing) {
  EXPECT_THAT(states(run()), ElementsAre("converted", "converted"));
  EXPECT_TRUE(fs::exists(batch_.out / "sub/b.glb"));
  const BatchReport again = run();
  EXPECT_THAT(states(again), ElementsAre("up to date", "up to date"));
  EXPECT_EQ(again.rows[0].triangles_in, 2u);
  EXPECT_EQ(exit_code(again), 0);
}

TEST_F(BatchRun, DoesAgainWhatChanged) {
  run();
  write_scene(square(2.5), folder_ / "in/a.glb");
  EXPECT_THAT(states(run()), ElementsAre("converted", "up to date"));
  std::ofstream(folder_ / "in/sub/b.bin", std::ios::in | std::ios::out | std::ios::binary).write("\1", 1); // a side file
  EXPECT_THAT(states(run()), ElementsAre("up to date", "converted"));
  EXPECT_THAT(states(run({{"tolerance", "0.4", ""}})), ElementsAre("converted", "converted"));
  fs::resize_file(batch_.out / "a.glb", 100);
  EXPECT_THAT(states(run({{"tolerance", "0.4", ""}})), ElementsAre("converted", "up to date"));
  fs::remove(batch_.out / "sub/b.glb");
  EXPECT_THAT(states(run({{"tolerance", "0.4", ""}})), ElementsAre("up to date", "converted"));
  write_file(stamp_path(batch_.out, "a.glb"), "{\"fingerprint\":");
  EXPECT_THAT(states(run({{"tolerance", "0.4", ""}})), ElementsAre("converted", "up to date"));
  batch_.force = true;
  EXPECT_THAT(states(run({{"tolerance", "0.4", ""}})), ElementsAre("converted", "converted"));
}

TEST_F(BatchRun, GoesOnAfterABadScene) {
  std::ofstream(folder_ / "in/broken.glb") << "glTF, not really";
  const BatchReport report = run();
  EXPECT_THAT(states(report), ElementsAre("converted", "failed", "converted"));
  EXPECT_THAT(report.rows[1].message, HasSubstr("broken.glb: "));
  EXPECT_FALSE(fs::exists(batch_.out / "broken.glb"));
  EXPECT_EQ(exit_code(report), 2);
}

TEST_F(BatchRun, RemembersABrokenPromise) {
  EXPECT_EQ(exit_code(run({{"max-triangles", "3", ""}})), 3);
  const BatchReport again = run({{"max-triangles", "3", ""}});
  EXPECT_THAT(states(again), ElementsAre("up to date", "up to date"));
  EXPECT_EQ(again.rows[0].status, BatchStatus::unkept);
  EXPECT_THAT(again.rows[0].message, HasSubstr("tolerance"));
  EXPECT_EQ(exit_code(again), 3);
}

TEST_F(BatchRun, RefusesWhatDoesNotFitIntoMemory) {
  batch_.max_memory = 1 << 20;
  const BatchReport report = run();
  EXPECT_THAT(states(report), ElementsAre("refused", "refused"));
  EXPECT_THAT(report.rows[0].message, HasSubstr("--max-memory allows 1 MiB"));
  EXPECT_EQ(exit_code(report), 3);
}

TEST_F(BatchRun, SaysWhichOutputCannotBeWritten) {
  fs::create_directories(batch_.out / "a.glb"); // a folder in the way
  const BatchReport report = run();
  EXPECT_THAT(states(report), ElementsAre("unwritten", "converted"));
  EXPECT_EQ(exit_code(report), 4);
}

TEST_F(BatchRun, RemovesWhatAKilledRunLeft) {
  fs::create_directories(batch_.out / "sub");
  std::ofstream(batch_.out / "sub/b.glb.Ab12Cd") << "half";
  std::ofstream(batch_.out / "sub/mine.glb.Ab12Cd") << "not of this batch";
  run();
  EXPECT_FALSE(fs::exists(batch_.out / "sub/b.glb.Ab12Cd"));
  EXPECT_TRUE(fs::exists(batch_.out / "sub/mine.glb.Ab12Cd"));
}

TEST_F(BatchRun, WritesTheSameBytesAsASingleConversion) {
  run();
  JobOptions job = parse_arguments({{"lens", "equidistant", ""}, {"size", "512x512", ""}, {"eye", "0,0,0", ""}});
  run_job(folder_ / "in/a.glb", folder_ / "single.glb", job);
  EXPECT_EQ(read_file(folder_ / "single.glb"), read_file(batch_.out / "a.glb"));
}

TEST_F(BatchRun, SumsUpInJsonWithStableKeys) {
  std::ofstream(folder_ / "in/\xff.glb") << "a name that is no UTF-8";
  const auto json = nlohmann::json::parse(to_json(run(), batch_.out, {2, 5}));
  EXPECT_EQ(json.at("counts").at("scenes"), 3);
  EXPECT_EQ(json.at("counts").at("converted"), 2);
  EXPECT_EQ(json.at("counts").at("failed"), 1);
  EXPECT_EQ(json.at("shard").at("count"), 5);
  EXPECT_EQ(json.at("scenes").at(0).at("output"), "a.glb");
  EXPECT_EQ(json.at("scenes").at(0).at("triangles").at("input"), 2);
  EXPECT_EQ(summary_name({2, 5}), "summary-2-of-5.json");
}

} // namespace
} // namespace domewarp
