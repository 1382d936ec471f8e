// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "domewarp/convert/batch_plan.h"
#include "domewarp/core/errors.h"
#include "job_arguments.h"

namespace domewarp {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::EndsWith;
using testing::HasSubstr;

class BatchPlan : public testing::Test {
protected:
  BatchPlan() {
    folder_ = fs::path(testing::TempDir()) / ("batch_plan_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
    fs::remove_all(folder_);
    fs::create_directories(folder_);
    options_.out = folder_ / "out";
    options_.parse = parse_arguments;
    options_.arguments = {{"lens", "equidistant", "--lens"}};
  }
  ~BatchPlan() override { fs::remove_all(folder_); }

  void touch(const std::string& name, const std::string& text = "") {
    fs::create_directories((folder_ / name).parent_path());
    std::ofstream(folder_ / name) << text;
  }

  std::vector<BatchItem> plan(const std::string& input) { return plan_batch({(folder_ / input).string()}, options_); }

  std::vector<std::string> outputs(const std::string& input) {
    std::vector<std::string> names;
    for (const BatchItem& item : plan(input)) names.push_back(item.output.string());
    return names;
  }

  std::string error_of(const std::string& input) {
    try {
      plan(input);
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::input);
      const std::string message = error.what(), folder = folder_.string() + "/";
      std::string shortened = message;
      for (std::size_t at; (at = shortened.find(folder)) != std::string::npos;) shortened.erase(at, folder.size());
      return shortened;
    }
    return "no error";
  }

  fs::path folder_;
  PlanOptions options_;
};

TEST_F(BatchPlan, KeepsTheStructureOfAFolderAndLeavesOutTheOutputs) {
  for (const char* name : {"in/a.glb", "in/deep/er/B.GLTF", "in/deep/picture.png", "in/out/old.glb"}) touch(name);
  options_.out = folder_ / "in/out";
  EXPECT_THAT(outputs("in"), ElementsAre("a.glb", "deep/er/B.glb"));
}

TEST_F(BatchPlan, DoesNotFollowLinksToFolders) {
  touch("in/a.glb");
  fs::create_directory_symlink("..", folder_ / "in/up");
  EXPECT_THAT(outputs("in"), ElementsAre("a.glb"));
}

TEST_F(BatchPlan, TellsOutputsOfOneNameApart) {
  for (const char* name : {"in/a.glb", "in/a.gltf", "in/b.gltf"}) touch(name);
  EXPECT_THAT(outputs("in"), ElementsAre("a_glb.glb", "a_gltf.glb", "b.glb"));
}

TEST_F(BatchPlan, GivesEachGltfOutputAFolderOfItsOwn) {
  for (const char* name : {"in/a.glb", "in/b.gltf"}) touch(name);
  options_.extension = ".gltf";
  EXPECT_THAT(outputs("in"), ElementsAre("a/a.gltf", "b/b.gltf"));
  touch("jobs.json", R"({"scenes": [{"input": "in/a.glb", "output": "x/a.gltf"}, {"input": "in/b.gltf", "output": "x/b.gltf"}]})");
  EXPECT_THAT(error_of("jobs.json"), HasSubstr("would both be written to out/x/ with their side files"));
}

TEST_F(BatchPlan, CountsAFileThatIsNamedTwiceOnce) {
  touch("in/a.glb");
  EXPECT_EQ(plan_batch({(folder_ / "in").string(), (folder_ / "in/a.glb").string(), (folder_ / "in/../in").string()}, options_).size(), 1u);
}

TEST_F(BatchPlan, LetsScenesOverruleDefaultsAndDefaultsTheCommandLine) {
  touch("jobs.json", R"({"defaults": {"curve": "1-r^2", "tolerance": 0.25, "unlit": true}, "scenes": [
    "a.glb", {"input": "b.glb", "lens": "equisolid", "tolerance": 2}, {"input": "c.glb", "unlit": false, "tolerance": null}]})");
  const std::vector<BatchItem> items = plan("jobs.json");
  ASSERT_EQ(items.size(), 3u);
  EXPECT_EQ(items[0].options->convert.surface.curve, "1-r^2");
  EXPECT_FALSE(items[0].options->convert.surface.lens);
  EXPECT_EQ(items[0].options->convert.refine.tolerance_px, 0.25);
  EXPECT_EQ(items[1].options->convert.surface.lens, Lens::equisolid);
  EXPECT_EQ(items[1].options->convert.surface.curve, "");
  EXPECT_EQ(items[1].options->convert.refine.tolerance_px, 2);
  EXPECT_EQ(items[2].options->convert.refine.tolerance_px, RefineOptions{}.tolerance_px);
  EXPECT_EQ(items[0].arguments, "curve=1-r^2\ntolerance=0.25\nunlit\n");
  EXPECT_EQ(items[2].arguments, "curve=1-r^2\n");
}

TEST_F(BatchPlan, KeepsTheFoldersBelowAManifestAndFindsProfilesBesideIt) {
  touch("sub/profile.txt", "0 1\n0.5 0.75\n1 0\n");
  touch("in/x/a.glb");
  touch("sub/jobs.json", R"({"defaults": {"profile": "profile.txt"}, "scenes": [
    "models/b.glb", {"input": "../in", "output": "moved"}, {"input": "../in/x/a.glb"}]})");
  EXPECT_THAT(outputs("sub/jobs.json"), ElementsAre("a.glb", "models/b.glb", "moved/x/a.glb"));
}

TEST_F(BatchPlan, NamesThePlaceOfABadOption) {
  const auto message = [&](const std::string& options) {
    touch("jobs.json", "{\"scenes\": [\"a.glb\",\n  {\"input\": \"b.glb\", " + options + "}]}");
    return error_of("jobs.json");
  };
  EXPECT_EQ(message("\"tolerance\": -1"), "jobs.json:2:22: scenes[1].tolerance: must be greater than 0, got -1");
  EXPECT_EQ(message("\"tolerance\": \"fine\""), "jobs.json:2:22: scenes[1].tolerance: needs a number, got 'fine'");
  EXPECT_EQ(message("\"tolerance\": true"), "jobs.json:2:22: scenes[1].tolerance: needs a value, got true");
  EXPECT_EQ(message("\"tolerance\": \"\""), "jobs.json:2:22: scenes[1].tolerance: is empty");
  EXPECT_EQ(message("\"tolerence\": 1"), "jobs.json:2:22: scenes[1].tolerence: there is no such option");
  EXPECT_EQ(message("\"report\": \"x\""), "jobs.json:2:22: scenes[1].report: there is no such option");
  EXPECT_EQ(message("\"help\": true"), "jobs.json:2:22: scenes[1].help: there is no such option");
  EXPECT_EQ(message("\"unlit\": \"maybe\""), "jobs.json:2:22: scenes[1].unlit: must be true or false, got 'maybe'");
  EXPECT_EQ(message("\"lens\": \"fish\""),
            "jobs.json:2:22: scenes[1].lens: must be one of equidistant|equisolid|orthographic|stereographic, got 'fish'");
  EXPECT_THAT(message("\"curve\": \"1-\""), HasSubstr("jobs.json:2:22: scenes[1].curve: "));
  EXPECT_THAT(message("\"curve\": \"1-r^2\", \"lens\": \"equisolid\""), HasSubstr("jobs.json:2:3: scenes[1]: exactly one of --curve"));
  EXPECT_EQ(message("\"eye\": [1, 2]"), "jobs.json:2:22: scenes[1].eye: needs three numbers X,Y,Z, got '1,2'");
}

TEST_F(BatchPlan, RefusesOutputsThatLeaveTheFolder) {
  for (const char* output : {"../x.glb", "/tmp/x.glb", "a/../../x.glb", ".domewarp/x.glb"}) {
    touch("jobs.json", "{\"scenes\": [{\"input\": \"a.glb\", \"output\": \"" + std::string(output) + "\"}]}");
    EXPECT_EQ(error_of("jobs.json"), "jobs.json:1:13: scenes[0].output: must stay inside the output folder, got '" + std::string(output) + "'");
  }
}

TEST_F(BatchPlan, RefusesTwoScenesForOneOutput) {
  touch("jobs.json", R"({"scenes": [{"input": "a.glb", "output": "x.glb"}, {"input": "b.glb", "output": "./x.glb"}]})");
  EXPECT_EQ(error_of("jobs.json"), "jobs.json:1:52: scenes[1]: b.glb and a.glb would both be written to out/x.glb");
}

TEST_F(BatchPlan, SharesOptionsBetweenScenesWithEqualOnes) {
  touch("jobs.json", R"({"scenes": ["a.glb", {"input": "b.glb", "fov": 90}, {"input": "c.glb", "fov": 90}]})");
  const std::vector<BatchItem> items = plan("jobs.json");
  EXPECT_NE(items[0].options, items[1].options);
  EXPECT_EQ(items[1].options, items[2].options);
}

TEST_F(BatchPlan, DealsEveryItemToExactlyOneShard) {
  for (int i = 0; i < 10; ++i) touch("in/" + std::to_string(i) + ".glb");
  const std::vector<BatchItem> items = plan("in");
  std::multiset<std::string> dealt;
  for (std::size_t k = 1; k <= 3; ++k)
    for (const BatchItem& item : shard(items, k, 3)) dealt.insert(item.output.string());
  EXPECT_EQ(dealt.size(), 10u);
  EXPECT_EQ(std::set<std::string>(dealt.begin(), dealt.end()).size(), 10u);
  EXPECT_TRUE(shard(items, 11, 11).empty());
}

TEST_F(BatchPlan, NamesAFolderWithoutScenes) {
  touch("in/readme.txt");
  EXPECT_EQ(error_of("in"), "in: holds no .glb or .gltf file");
}

} // namespace
} // namespace domewarp
