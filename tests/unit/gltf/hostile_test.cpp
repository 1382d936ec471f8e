// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <filesystem>
#include <functional>
#include <limits>

#include <gtest/gtest.h>

#include "gltf_file.h"

namespace domewarp::test {
namespace {

/// What reading says after a change to the good triangle.
std::string after(const std::function<void(GltfFile&)>& change) {
  GltfFile file = triangle_file();
  change(file);
  return refusal(file);
}

void expect_refusal(const std::string& text, const std::function<void(GltfFile&)>& change) {
  const std::string message = after(change);
  EXPECT_NE(message.find(text), std::string::npos) << "expected \"" << text << "\", got \"" << message << "\"";
  EXPECT_NE(message.find("file.glb: "), std::string::npos) << message;
}

TEST(Hostile, TheUnchangedFileIsRead) {
  EXPECT_EQ(after([](GltfFile&) {}), "");
}

TEST(Hostile, RefusesLoopsOfNodes) {
  expect_refusal("loop of nodes", [](GltfFile& file) {
    file.root["nodes"] = {{{"mesh", 0}}, {{"children", {2}}}, {{"children", {1}}}};
  });
  expect_refusal("loop of nodes", [](GltfFile& file) { file.root["nodes"][0]["children"] = {0}; });
}

TEST(Hostile, RefusesNodesWithTwoParents) {
  expect_refusal("two parents", [](GltfFile& file) {
    file.root["nodes"] = {{{"children", {2}}}, {{"children", {2}}}, {{"mesh", 0}}};
  });
}

TEST(Hostile, ReadsATreeOfAHundredThousandLevels) {
  GltfFile file = triangle_file();
  const int levels = 100000;
  file.root["nodes"] = json::array();
  for (int i = 0; i < levels; ++i) file.root["nodes"].push_back({{"children", {i + 1}}});
  file.root["nodes"].push_back({{"mesh", 0}});
  file.root["scenes"][0]["nodes"] = {0};
  EXPECT_EQ(file.read().instances.size(), 1u);
}

TEST(Hostile, RefusesAccessorsBeyondTheirView) {
  expect_refusal("accessors[0]", [](GltfFile& file) { file.root["accessors"][0]["count"] = 4; });
  expect_refusal("accessors[0]", [](GltfFile& file) { file.root["accessors"][0]["byteOffset"] = 4; });
  expect_refusal("accessors[0]", [](GltfFile& file) { file.root["accessors"][0]["count"] = 1ull << 52; });
  expect_refusal("accessors[0]", [](GltfFile& file) { file.root["accessors"][0]["byteOffset"] = (1ull << 53) - 4; });
}

TEST(Hostile, RefusesViewsBeyondTheirBuffer) {
  expect_refusal("bufferViews[0]", [](GltfFile& file) { file.root["bufferViews"][0]["byteLength"] = 1u << 31; });
  expect_refusal("bufferViews[0]", [](GltfFile& file) {
    file.root["bufferViews"][0]["byteOffset"] = (1ull << 53) - 1;
    file.root["bufferViews"][0]["byteLength"] = 36;
  });
}

TEST(Hostile, RefusesABufferLongerThanItsData) {
  expect_refusal("buffers[0]", [](GltfFile& file) { file.root["buffers"] = {{{"byteLength", 1ull << 40}}}; });
}

TEST(Hostile, RefusesNumbersThatAreNoIndices) {
  for (const json& index : {json(-1), json(1.5), json("0"), json(1e300), json(18446744073709551615ull), json(nullptr)})
    expect_refusal("nodes[0].mesh", [&](GltfFile& file) { file.root["nodes"][0]["mesh"] = index; });
}

TEST(Hostile, RefusesBillionsOfElementsWithoutData) {
  expect_refusal("elements without data", [](GltfFile& file) {
    file.root["accessors"][0].erase("bufferView");
    file.root["accessors"][0]["count"] = 4000000000u;
  });
}

TEST(Hostile, RefusesMoreMemoryThanAllowed) {
  // Many primitives that draw one accessor: a small file that asks for much.
  GltfFile file = triangle_file();
  file.root["accessors"][0].erase("bufferView");
  file.root["accessors"][0]["count"] = 1 << 20;
  for (int i = 0; i < 100; ++i) file.root["meshes"][0]["primitives"].push_back(file.root["meshes"][0]["primitives"][0]);
  EXPECT_NE(refusal(file, {.max_bytes = std::size_t(1) << 28}).find("more than the limit leaves"), std::string::npos);
}

TEST(Hostile, RefusesNestingBeforeItIsParsed) {
  const TemporaryFolder folder;
  write_text(folder / "deep.gltf", R"({"asset":{"version":"2.0"},"extras":)" + std::string(1000000, '['));
  EXPECT_NE(refusal(folder / "deep.gltf").find("nested deeper than 128"), std::string::npos);
  write_text(folder / "flat.gltf",
             R"({"asset":{"version":"2.0"},"extras":"[[[[)" + std::string(1000, '[') + "\\\"[\"}");
  EXPECT_EQ(refusal(folder / "flat.gltf"), "");
}

TEST(Hostile, SaysWhereJsonIsBroken) {
  const TemporaryFolder folder;
  write_text(folder / "broken.gltf", "{\n  \"asset\": }");
  EXPECT_NE(refusal(folder / "broken.gltf").find("line 2, column 12"), std::string::npos)
      << refusal(folder / "broken.gltf");
  write_text(folder / "huge_number.gltf", R"({"asset":{"version":"2.0"},"scene":1e999})");
  EXPECT_NE(refusal(folder / "huge_number.gltf").find("number overflow"), std::string::npos);
  write_text(folder / "not_utf8.gltf", "{\"asset\":{\"version\":\"2.0\",\"copyright\":\"\xff\"}}");
  EXPECT_NE(refusal(folder / "not_utf8.gltf").find("UTF-8"), std::string::npos);
  write_text(folder / "picture.gltf", "\x89PNG");
  EXPECT_NE(refusal(folder / "picture.gltf").find("neither a GLB nor JSON"), std::string::npos);
}

TEST(Hostile, RefusesPositionsThatAreNotFinite) {
  for (const float bad : {std::numeric_limits<float>::infinity(), std::numeric_limits<float>::quiet_NaN()})
    expect_refusal("POSITION: is not finite at vertex 1", [&](GltfFile& file) {
      const int positions = file.add(std::vector<float>{0, 0, 0, 0, bad, 0, 1, 0, 0}, "VEC3");
      file.root["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = positions;
    });
}

TEST(Hostile, RefusesMatricesThatAreNotAffineOrOverflow) {
  expect_refusal("nodes[0]", [](GltfFile& file) {
    file.root["nodes"][0]["matrix"] = {1, 0, 0, 0.5, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
  });
  expect_refusal("overflows", [](GltfFile& file) {
    file.root["nodes"] = {{{"scale", {1e30, 1, 1}}, {"children", {1}}}, {{"scale", {1e300, 1, 1}}, {"mesh", 0}}};
  });
}

TEST(Hostile, RefusesNodesBeyondSinglePrecision) {
  const auto scaled_by = [](double scale) {
    return [scale](GltfFile& file) { file.root["nodes"][0]["scale"] = {1, scale, 1}; };
  };
  expect_refusal("beyond what single precision holds", scaled_by(1e200));
  EXPECT_EQ(after(scaled_by(1e30)), "");
}

TEST(Hostile, RefusesIndicesOutOfRangeAndRestarts) {
  expect_refusal("vertex 3 of 3", [](GltfFile& file) {
    file.root["meshes"][0]["primitives"][0]["indices"] = file.add(std::vector<std::uint16_t>{0, 1, 3}, "SCALAR");
  });
  expect_refusal("restart", [](GltfFile& file) {
    file.root["meshes"][0]["primitives"][0]["indices"] =
        file.add(std::vector<std::uint16_t>{0, 1, 2, 65535, 0, 1}, "SCALAR");
  });
  expect_refusal("componentType 5126", [](GltfFile& file) {
    file.root["meshes"][0]["primitives"][0]["indices"] = file.add(std::vector<float>{0, 1, 2}, "SCALAR");
  });
}

TEST(Hostile, RefusesSparseIndicesOutOfRange) {
  expect_refusal("has the index 3 of 3 elements", [](GltfFile& file) {
    const std::uint8_t index = 3;
    const float value[3] = {};
    const int indices = file.add_view(&index, 1), values = file.add_view(value, sizeof(value));
    file.root["accessors"][0]["sparse"] = {{"count", 1},
                                           {"indices", {{"bufferView", indices}, {"componentType", 5121}}},
                                           {"values", {{"bufferView", values}}}};
  });
}

TEST(Hostile, TellsSparseCountsAsTheyAre) {
  expect_refusal("sparse: replaces 2147483648 elements, too many", [](GltfFile& file) {
    file.root["accessors"][0]["sparse"] = {{"count", 2147483648u},
                                           {"indices", {{"bufferView", 0}, {"componentType", 5125}}},
                                           {"values", {{"bufferView", 0}}}};
  });
}

TEST(Hostile, RefusesAttributesOfAnotherLength) {
  expect_refusal("has 2 vertices, POSITION has 3", [](GltfFile& file) {
    file.root["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"] =
        file.add(std::vector<float>{0, 0, 1, 1}, "VEC2");
  });
}

TEST(Hostile, RefusesUnknownRequiredExtensionsByName) {
  expect_refusal("needs ACME_teleport", [](GltfFile& file) {
    file.root["extensionsUsed"] = file.root["extensionsRequired"] = {"ACME_teleport"};
  });
}

TEST(Hostile, RefusesOtherVersions) {
  expect_refusal("\"1.0\"", [](GltfFile& file) { file.root["asset"]["version"] = "1.0"; });
  expect_refusal("\"3.0\"", [](GltfFile& file) { file.root["asset"]["minVersion"] = "3.0"; });
}

/// A .gltf beside a folder that holds a buffer it should not reach.
struct Escape {
  TemporaryFolder folder;
  std::filesystem::path file;

  explicit Escape(const std::string& uri) {
    GltfFile good = triangle_file();
    std::filesystem::create_directory(folder / "inside");
    write_bytes(folder / "secret.bin", good.binary);
    std::filesystem::create_symlink(folder / "secret.bin", folder / "inside/link.bin");
    write_bytes(folder / "inside/plain.bin", good.binary);
    std::filesystem::create_symlink(folder / "inside/plain.bin", folder / "inside/alias.bin");
    const bool absolute = uri.starts_with("/");
    good.root["buffers"] = {
        {{"byteLength", good.binary.size()}, {"uri", absolute ? (folder / "secret.bin").string() : uri}}};
    file = folder / "inside/file.gltf";
    write_text(file, good.root.dump());
  }
};

TEST(Hostile, RefusesUrisThatLeaveTheFolder) {
  for (const char* uri : {"../secret.bin", "%2e%2e/secret.bin", "..%2Fsecret.bin", "/", "./../secret.bin", "link.bin",
                          "x/../../secret.bin"}) {
    const Escape escape(uri);
    EXPECT_NE(refusal(escape.file).find("leaves the folder"), std::string::npos) << uri << ": " << refusal(escape.file);
    const bool exists = std::string(uri) != "x/../../secret.bin";
    EXPECT_EQ(refusal(escape.file, {.allow_external = true}).empty(), exists) << uri;
  }
  for (const char* uri : {"plain.bin", "./plain.bin", "alias.bin", "pl%61in.bin"})
    EXPECT_EQ(refusal(Escape(uri).file), "") << uri;
}

TEST(Hostile, RefusesUrisWithASchemeAndBrokenOnes) {
  for (const char* uri :
       {"file:///etc/hostname", "http://example.com/a.bin", "C:\\a.bin", ":", "%zz", "a%00b", "..\\secret.bin", ""})
    EXPECT_NE(refusal(Escape(uri).file), "") << uri;
}

TEST(Hostile, RefusesImagesThatLeaveTheFolderToo) {
  expect_refusal("images[0]: URI \"../a.png\" leaves", [](GltfFile& file) {
    file.root["images"] = {{{"uri", "../a.png"}}};
  });
}

TEST(Hostile, RefusesAFolderAndAMissingFile) {
  const TemporaryFolder folder;
  EXPECT_NE(refusal(folder.path).find("not a regular file"), std::string::npos);
  EXPECT_NE(refusal(folder / "none.glb").find("no such file"), std::string::npos);
}

TEST(Hostile, LeavesBrokenImagesOutWithAWarning) {
  const std::vector<std::uint8_t> png = tiny_png();
  const auto scene_with = [](std::vector<std::uint8_t> bytes) {
    GltfFile file = triangle_file();
    file.root["images"] = {{{"mimeType", "image/png"}, {"bufferView", file.add_view(bytes.data(), bytes.size())}}};
    return file.read();
  };
  EXPECT_EQ(scene_with(png).images.at(0).bytes, png);
  const Scene cut = scene_with({png.begin(), png.end() - 8});
  EXPECT_TRUE(cut.images.at(0).bytes.empty());
  EXPECT_TRUE(warns(cut, "images[0]: is left out"));
  EXPECT_TRUE(scene_with({'n', 'o', 'n', 'e'}).images.at(0).bytes.empty());
}

} // namespace
} // namespace domewarp::test
