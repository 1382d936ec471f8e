// SPDX-License-Identifier: Apache-2.0
#include "domewarp/scene/image.h"

#include <random>

#include <gtest/gtest.h>
#include <turbojpeg.h>
#include <webp/encode.h>

#include "domewarp/core/errors.h"

namespace domewarp {
namespace {

std::vector<std::uint8_t> random_bytes(std::size_t count) {
  std::mt19937 random(1);
  std::vector<std::uint8_t> bytes(count);
  for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random() % 256);
  return bytes;
}

std::string message_of(const std::vector<std::uint8_t>& bytes) {
  try {
    decode_image(bytes, "wall.png");
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::input);
    return error.what();
  }
  return "";
}

TEST(Image, PngComesBackByteForByte) {
  const std::vector<std::uint8_t> samples = random_bytes(5 * 3 * 4);
  const Pixels pixels = decode_image(encode_png(5, 3, 4, samples), "test");
  EXPECT_EQ(pixels.width, 5);
  EXPECT_EQ(pixels.height, 3);
  EXPECT_EQ(pixels.rgba, samples);
}

TEST(Image, PngWithFewerChannelsIsFilledUp) {
  const std::uint8_t grey[] = {0, 77, 255, 9};
  const Pixels pixels = decode_image(encode_png(2, 2, 1, grey), "test");
  EXPECT_EQ(std::vector<std::uint8_t>(pixels.rgba.begin() + 4, pixels.rgba.begin() + 8),
            (std::vector<std::uint8_t>{77, 77, 77, 255}));
}

TEST(Image, PngIsWrittenTheSameTwice) {
  const std::vector<std::uint8_t> samples = random_bytes(64 * 64 * 3);
  EXPECT_EQ(encode_png(64, 64, 3, samples), encode_png(64, 64, 3, samples));
}

TEST(Image, PngRefusesAWrongNumberOfSamples) {
  EXPECT_THROW(encode_png(4, 4, 3, random_bytes(47)), Error);
  EXPECT_THROW(encode_png(0, 4, 3, {}), Error);
  EXPECT_THROW(encode_png(1, 1, 5, random_bytes(5)), Error);
}

TEST(Image, WebpWithoutLossComesBackByteForByte) {
  std::vector<std::uint8_t> samples = random_bytes(6 * 4 * 4);
  for (std::size_t i = 3; i < samples.size(); i += 4) samples[i] = 255;
  std::uint8_t* packed = nullptr;
  const std::size_t size = WebPEncodeLosslessRGBA(samples.data(), 6, 4, 24, &packed);
  const std::vector<std::uint8_t> bytes(packed, packed + size);
  WebPFree(packed);
  EXPECT_EQ(decode_image(bytes, "test").rgba, samples);
  EXPECT_THROW(decode_image(std::span(bytes).first(bytes.size() / 2), "test"), Error);
}

TEST(Image, JpegComesBackNearly) {
  const std::vector<std::uint8_t> samples(16 * 16 * 3, 120);
  const tjhandle encoder = tjInitCompress();
  unsigned char* packed = nullptr;
  unsigned long size = 0;
  ASSERT_EQ(tjCompress2(encoder, samples.data(), 16, 0, 16, TJPF_RGB, &packed, &size, TJSAMP_444, 95, 0), 0);
  const std::vector<std::uint8_t> bytes(packed, packed + size);
  tjFree(packed);
  tjDestroy(encoder);
  const Pixels pixels = decode_image(bytes, "test");
  ASSERT_EQ(pixels.rgba.size(), 16u * 16 * 4);
  EXPECT_NEAR(pixels.rgba[0], 120, 2);
  EXPECT_EQ(pixels.rgba[3], 255);
}

TEST(Image, EveryCutPngIsReadOrNamedInAnError) {
  const std::vector<std::uint8_t> bytes = encode_png(9, 7, 4, random_bytes(9 * 7 * 4));
  for (std::size_t length = 0; length + 12 < bytes.size(); ++length)
    EXPECT_NE(message_of({bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(length)}).find("wall.png"),
              std::string::npos)
        << length;
}

TEST(Image, EveryFlippedByteOfAPngIsHarmless) {
  const std::vector<std::uint8_t> bytes = encode_png(9, 7, 4, random_bytes(9 * 7 * 4));
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    std::vector<std::uint8_t> broken = bytes;
    broken[i] ^= 0x41;
    message_of(broken);
  }
}

TEST(Image, ARequestForTooManyPixelsIsRefusedBeforeMemoryIsTaken) {
  std::vector<std::uint8_t> bytes = {0xff, 0xd8, 0xff, 0xc0, 0,    17,   8, 0xea, 0x60, 0xea, 0x60, 3,
                                     1,    0x11, 0,    2,    0x11, 1,    3, 0x11, 1,    0xff, 0xda, 0,
                                     12,   3,    1,    0,    2,    0x11, 3, 0x11, 0,    63,   0};
  EXPECT_NE(message_of(bytes).find("60000 x 60000"), std::string::npos) << message_of(bytes);
}

TEST(Image, UnknownBytesAreRefused) {
  EXPECT_NE(message_of({'G', 'I', 'F', '8'}).find("neither PNG"), std::string::npos);
}

} // namespace
} // namespace domewarp
