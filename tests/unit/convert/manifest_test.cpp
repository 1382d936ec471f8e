// SPDX-License-Identifier: Apache-2.0
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "domewarp/convert/manifest.h"
#include "domewarp/core/errors.h"

namespace domewarp {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

std::string error_of(const std::string& text) {
  try {
    parse_manifest(text, "jobs.json");
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::input);
    return error.what();
  }
  return "no error";
}

TEST(Manifest, ReadsDefaultsAndScenesWithTheirPlaces) {
  const Manifest manifest = parse_manifest(R"({
  "defaults": {"lens": "equidistant", "tolerance": 0.25},
  "scenes": [
    "a.glb",
    {"input": "b/b.gltf", "output": "c.glb",
     "eye": [0, -1.5, 2e3], "unlit": true, "draco": false, "fov": null}
  ]})", "jobs.json");
  ASSERT_EQ(manifest.defaults.size(), 2u);
  EXPECT_EQ(manifest.defaults[1].name, "tolerance");
  EXPECT_EQ(manifest.defaults[1].value, "0.25");
  EXPECT_EQ(to_string("m", manifest.defaults[1].place), "m:2:39");
  ASSERT_EQ(manifest.scenes.size(), 2u);
  EXPECT_EQ(manifest.scenes[0].input, "a.glb");
  EXPECT_EQ(to_string("m", manifest.scenes[0].place), "m:4:5");
  const ManifestScene& scene = manifest.scenes[1];
  EXPECT_EQ(scene.input, "b/b.gltf");
  EXPECT_EQ(scene.output, "c.glb");
  EXPECT_EQ(to_string("m", scene.place), "m:5:5");
  ASSERT_EQ(scene.options.size(), 4u);
  EXPECT_EQ(scene.options[0].value, "0,-1.5,2e3");
  EXPECT_EQ(to_string("m", scene.options[0].place), "m:6:6");
  EXPECT_EQ(scene.options[1].kind, ManifestOption::Kind::on);
  EXPECT_EQ(scene.options[2].kind, ManifestOption::Kind::off);
  EXPECT_EQ(scene.options[3].kind, ManifestOption::Kind::off);
}

TEST(Manifest, CountsColumnsInCharactersAndFindsKeysWithEscapes) {
  const Manifest manifest = parse_manifest("{\"scenes\":[{\"input\":\"\u00e4\u2764.glb\", \"a\\\"\\\\b\": 1}]}", "m");
  ASSERT_EQ(manifest.scenes.size(), 1u);
  EXPECT_EQ(manifest.scenes[0].options[0].name, "a\"\\b");
  EXPECT_EQ(manifest.scenes[0].options[0].place.column, 31u);
}

TEST(Manifest, NamesThePlaceOfASyntaxError) {
  EXPECT_THAT(error_of("{\"scenes\": [\n  \"a.glb\"\n  \"b.glb\"\n]}"), StartsWith("jobs.json:3:9: is no JSON: "));
  EXPECT_THAT(error_of("{\"scenes\": ["), StartsWith("jobs.json:1:13: is no JSON: "));
  EXPECT_THAT(error_of(""), StartsWith("jobs.json:1:1: is no JSON: "));
}

struct BadManifest {
  const char* text;
  const char* message;
};

class ManifestRefuses : public testing::TestWithParam<BadManifest> {};

TEST_P(ManifestRefuses, NamingTheKey) { EXPECT_EQ(error_of(GetParam().text), std::string("jobs.json") + GetParam().message); }

INSTANTIATE_TEST_SUITE_P(
    Shapes, ManifestRefuses,
    testing::Values(BadManifest{"{}", ": has no \"scenes\""}, BadManifest{"[]", ":1:1: manifest: must not be a list"},
                    BadManifest{"17", ":1:1: manifest: must be an object with \"scenes\""},
                    BadManifest{"17\"", ":1:1: manifest: must be an object with \"scenes\""}, // a quote where none was opened
                    BadManifest{"{\"scene\": []}", ":1:2: scene: no such key; there are \"defaults\" and \"scenes\""},
                    BadManifest{"{\"scenes\": {}}", ":1:2: scenes: must be a list"},
                    BadManifest{"{\"scenes\": 3}", ":1:2: scenes: must be a list"},
                    BadManifest{"{\"defaults\": []}", ":1:2: defaults: must not be a list"},
                    BadManifest{"{\"scenes\": [], \"scenes\": []}", ":1:16: scenes: stands here twice"},
                    BadManifest{"{\"scenes\": [\"a\", 17]}", ":1:18: scenes[1]: must be a file name or an object"},
                    BadManifest{"{\"scenes\": [[]]}", ":1:13: scenes[0]: must not be a list"},
                    BadManifest{"{\"scenes\": [\"\"]}", ":1:13: scenes[0]: is empty"},
                    BadManifest{"{\"scenes\": [{\"lens\": \"x\"}]}", ":1:13: scenes[0]: has no \"input\""},
                    BadManifest{"{\"scenes\": [{\"input\": 3}]}", ":1:14: scenes[0].input: must be a text"},
                    BadManifest{"{\"scenes\": [{\"input\": [3]}]}", ":1:14: scenes[0].input: must not be a list"},
                    BadManifest{"{\"scenes\": [{\"input\": \"a\\u0000b\"}]}", ":1:14: scenes[0].input: holds a NUL character"},
                    BadManifest{"{\"scenes\": [{\"input\": \"a\", \"eye\": [1, \"2\"]}]}", ":1:28: scenes[0].eye: must be a list of numbers"},
                    BadManifest{"{\"scenes\": [{\"input\": \"a\", \"eye\": [[1]]}]}", ":1:28: scenes[0].eye: must not be a list"},
                    BadManifest{"{\"scenes\": [{\"input\": \"a\", \"eye\": {}}]}",
                                ":1:28: scenes[0].eye: needs a text, a number, true, false or a list of numbers, got an object"},
                    BadManifest{"{\"scenes\": [{\"input\": \"a\", \"fov\": 1, \"fov\": 2}]}", ":1:38: scenes[0].fov: stands here twice"},
                    BadManifest{"{\"defaults\": {\"input\": \"a\"}}", ":1:15: defaults.input: belongs to a scene"}));

TEST(Manifest, ReadsAHundredThousandScenesInATimeThatGrowsWithThem) {
  std::string text = "{\"scenes\": [\"0.glb\"";
  for (int i = 1; i < 100000; ++i) text += ",\n  {\"input\": \"" + std::to_string(i) + ".glb\", \"fov\": 180}";
  const Manifest manifest = parse_manifest(text + "]}", "m");
  ASSERT_EQ(manifest.scenes.size(), 100000u);
  EXPECT_EQ(manifest.scenes.back().options[0].place.line, 100000u);
}

} // namespace
} // namespace domewarp
