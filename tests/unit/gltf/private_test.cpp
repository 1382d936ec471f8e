// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include <glm/geometric.hpp>

#include "domewarp/gltf/decompose.h"
#include "domewarp/gltf/image_format.h"
#include "domewarp/gltf/nodes.h"
#include "domewarp/gltf/uri.h"
#include "gltf_file.h"

namespace domewarp::gltf {
namespace {

Mat4 composed(const Decomposition& parts) {
  const auto list = [](const auto& v) {
    std::vector<double> values;
    for (int i = 0; i < v.length(); ++i) values.push_back(v[i]);
    return values;
  };
  return matrix_of(list(parts.translation), list(parts.outer), list(parts.scale)) *
         matrix_of({}, list(parts.inner), {});
}

double difference(const Mat4& a, const Mat4& b) {
  double largest = 0;
  for (int c = 0; c < 4; ++c)
    for (int r = 0; r < 4; ++r) largest = std::max(largest, std::abs(a[c][r] - b[c][r]));
  return largest;
}

TEST(Decompose, RebuildsAnyAffineMatrix) {
  std::mt19937 random(7);
  std::normal_distribution<double> number;
  for (int trial = 0; trial < 500; ++trial) {
    Mat4 matrix(1);
    for (int c = 0; c < 4; ++c)
      for (int r = 0; r < 3; ++r) matrix[c][r] = number(random);
    if (trial % 5 == 1) matrix[1] = matrix[0];                       // flat
    if (trial % 5 == 2) matrix[1] = matrix[2] = Vec4(0);             // a line
    if (trial % 5 == 3) matrix[0] = matrix[1] = matrix[2] = Vec4(0); // a point
    if (trial % 5 == 4) matrix[0] *= 1e-9;
    EXPECT_LT(difference(composed(decompose(matrix)), matrix), 1e-13) << "seed 7, trial " << trial;
  }
}

TEST(Decompose, KnowsWhatOneNodeCanHold) {
  EXPECT_TRUE(is_decomposable(Mat4(1)));
  EXPECT_TRUE(is_decomposable(matrix_of({1, 2, 3}, {0.5, 0.5, 0.5, 0.5}, {-1, 2, 3})));
  EXPECT_FALSE(is_decomposable(matrix_of({}, {}, {1, 2, 3}) * matrix_of({}, {0, 0, 0.6, 0.8}, {})));
  EXPECT_FALSE(is_decomposable(matrix_of({}, {}, {1, 0, 1})));
  EXPECT_TRUE(is_diagonal(matrix_of({1, 2, 3}, {}, {1, 0, -1})));
  EXPECT_FALSE(is_diagonal(matrix_of({}, {0.5, 0.5, 0.5, 0.5}, {})));
}

TEST(Uri, DecodesDataUris) {
  const auto text = [](const char* uri) {
    const std::optional<DataUri> data = decode_data_uri(uri);
    return data ? std::string(data->bytes.begin(), data->bytes.end()) : "refused";
  };
  EXPECT_EQ(text("data:text/plain;base64,aGVsbG8="), "hello");
  EXPECT_EQ(text("data:;base64,aGVsbG8"), "hello");
  EXPECT_EQ(text("data:,a%20b"), "a b");
  EXPECT_EQ(text("data:;base64,a*b="), "refused");
  EXPECT_EQ(text("data:;base64,abcde"), "refused");
  EXPECT_EQ(text("data:nothing"), "refused");
  EXPECT_EQ(decode_data_uri("data:image/png;base64,")->mime, "image/png");
}

TEST(Uri, EncodesWhatItDecodes) {
  const std::string name = "a b/\xE2\x9D\xA4#?%.png";
  EXPECT_EQ(percent_encode(name), "a%20b/%E2%9D%A4%23%3F%25.png");
  EXPECT_EQ(percent_decode(percent_encode(name)), name);
  EXPECT_EQ(percent_decode("%4"), std::nullopt);
  EXPECT_EQ(percent_decode("%00"), std::nullopt);
}

TEST(ImageFormat, TellsFormatsAndDefects) {
  std::vector<std::uint8_t> png = test::tiny_png();
  EXPECT_EQ(sniff_mime(png), "image/png");
  EXPECT_EQ(image_defect(png, "image/png"), "");
  for (std::size_t size = 8; size < png.size(); ++size)
    EXPECT_NE(image_defect(std::span(png).first(size), "image/png"), "") << size;
  png[19] = 0;
  EXPECT_EQ(image_defect(png, "image/png"), "its PNG has no pixels");
  const std::vector<std::uint8_t> jpeg = {0xFF, 0xD8, 0xFF, 0xE0, 0, 4, 0, 0, 0xFF, 0xC0, 0,
                                          11,   8,    0,    1,    0, 1, 1, 1, 0x11, 0};
  EXPECT_EQ(sniff_mime(jpeg), "image/jpeg");
  EXPECT_EQ(image_defect(jpeg, "image/jpeg"), "");
  for (std::size_t size = 2; size < jpeg.size(); ++size)
    EXPECT_NE(image_defect(std::span(jpeg).first(size), "image/jpeg"), "") << size;
  EXPECT_EQ(sniff_mime(std::vector<std::uint8_t>{'R', 'I', 'F'}), "");
}

} // namespace
} // namespace domewarp::gltf
