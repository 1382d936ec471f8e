// SPDX-License-Identifier: Apache-2.0
#include "domewarp/profile/measured.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <random>
#include <string>

#include <gtest/gtest.h>
#include <unistd.h>

#include "domewarp/core/errors.h"

namespace domewarp {
namespace {

class ProfileFile : public testing::Test {
protected:
  ~ProfileFile() override { std::filesystem::remove(path_); }
  std::vector<Vec2> read(const std::string& text) {
    std::ofstream(path_, std::ios::binary) << text;
    return read_profile(path_);
  }
  std::string complaint(const std::string& text) {
    try {
      read(text);
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::input);
      EXPECT_EQ(std::string(error.what()).rfind(path_.string(), 0), 0u) << error.what();
      return error.what();
    }
    return "";
  }
  std::filesystem::path path_ =
      std::filesystem::temp_directory_path() / ("profile_" + std::to_string(::getpid()) + ".txt");
};

TEST_F(ProfileFile, ReadsRowsAmongCommentsAndBlankLines) {
  const std::vector<Vec2> rows = read("# r z\n0 1\n\n 0.5\t0.75 \r\n1,0\n1.5;-1");
  ASSERT_EQ(rows.size(), 4u);
  EXPECT_EQ(rows[1], Vec2(0.5, 0.75));
  EXPECT_EQ(rows[3], Vec2(1.5, -1));
}

TEST_F(ProfileFile, RefusalsNameTheLine) {
  const auto expect = [this](const std::string& text, const std::string& line, const std::string& what) {
    const std::string message = complaint(text);
    EXPECT_NE(message.find(line), std::string::npos) << message;
    EXPECT_NE(message.find(what), std::string::npos) << message;
  };
  expect("0 1\n0.5 0.8\n0.4 0.7\n", "line 3", "must increase");
  expect("0 1\n# x\n0.5 0.8\n0.5 0.8\n", "line 4", "twice");
  expect("0 1\n0.5 nan\n", "line 2", "finite");
  expect("0 1\ninf 0\n", "line 2", "finite");
  expect("0.1 1\n0.5 0.8\n", "line 1", "r = 0");
  expect("0 1\n0.5\n", "line 2", "two numbers");
  expect("0 1\n0.5 0.8 0.7\n", "line 2", "two numbers");
  expect("0 1\n0.5 abc\n", "line 2", "two numbers");
  expect("0 1\n1e999 2\n", "line 2", "two numbers");
  expect("0 1\n", "at least two rows", "found 1");
  expect("", "at least two rows", "found 0");
  expect(std::string("0 1\n\0 2\n", 9), "line 2", "two numbers");
}

std::vector<Vec2> random_rows(std::mt19937_64& random, int count) {
  std::uniform_real_distribution<double> uniform(0, 1);
  std::vector<Vec2> rows{{0, 1}};
  for (int i = 1; i < count; ++i) rows.emplace_back(rows.back().x + 0.01 + uniform(random), 4 * uniform(random) - 2);
  return rows;
}

TEST(MeasuredCurve, PassesThroughTheRowsAndOvershootsNone) {
  std::mt19937_64 random(3);
  for (int trial = 0; trial < 50; ++trial) {
    const std::vector<Vec2> rows = random_rows(random, 2 + trial % 9);
    const MeasuredCurve curve = fit_measured(rows, "rows");
    for (std::size_t i = 0; i + 1 < rows.size(); ++i) {
      EXPECT_NEAR(evaluate(curve, rows[i].x), rows[i].y, 1e-14);
      EXPECT_NEAR(evaluate(curve, rows[i + 1].x), rows[i + 1].y, 1e-13);
      double last = rows[i].y;
      const double direction = rows[i + 1].y - rows[i].y;
      for (int k = 1; k <= 100; ++k) {
        const double z = evaluate(curve, std::min(rows[i].x + (rows[i + 1].x - rows[i].x) * k / 100, rows[i + 1].x));
        EXPECT_GE((z - last) * direction, -1e-12);
        last = z;
      }
    }
  }
}

TEST(MeasuredCurve, IsSmoothToFirstOrderAndFollowsAParabola) {
  std::vector<Vec2> rows;
  for (int i = 0; i <= 100; ++i) rows.emplace_back(0.01 * i, 1 - 1e-4 * i * i);
  const MeasuredCurve curve = fit_measured(rows, "rows");
  for (int i = 1; i < 1000; ++i) {
    const double r = i * 1e-3;
    EXPECT_NEAR(evaluate(curve, r), 1 - r * r, 2e-5);
    EXPECT_NEAR(differentiate(curve, std::nextafter(r, 0)).d, differentiate(curve, r).d, 1e-11);
    EXPECT_NEAR(differentiate(curve, r).d, (evaluate(curve, r + 1e-7) - evaluate(curve, r - 1e-7)) / 2e-7, 1e-5);
  }
  EXPECT_TRUE(std::isnan(evaluate(curve, 1.01)));
}

TEST(MeasuredCurve, EnclosuresHoldTheValues) {
  std::mt19937_64 random(4);
  std::uniform_real_distribution<double> uniform(0, 1);
  const std::vector<Vec2> rows = random_rows(random, 12);
  const MeasuredCurve curve = fit_measured(rows, "rows");
  for (int i = 0; i < 10000; ++i) {
    const std::size_t k = random() % (rows.size() - 1);
    const double a = uniform(random), b = a + (1 - a) * uniform(random), h = rows[k + 1].x - rows[k].x;
    const Interval cell(rows[k].x + h * a, std::min(rows[k].x + h * b, rows[k + 1].x));
    const double r = cell.lo + (cell.hi - cell.lo) * uniform(random);
    const Jet<Interval> jet = enclose_jet(curve, cell);
    const Jet<double> at = differentiate(curve, r);
    ASSERT_TRUE(contains(jet.v, at.v) && contains(jet.d, at.d) && contains(jet.dd, at.dd));
  }
}

TEST(MeasuredCurve, RowsThatDidNotComeFromAFileAreCheckedToo) {
  EXPECT_THROW(fit_measured({{0, 1}, {0.5, 1}, {0.4, 1}}, "rows"), Error);
  EXPECT_THROW(fit_measured({{0, 1}}, "rows"), Error);
  EXPECT_THROW(fit_measured({{0, 1}, {1e-320, -1e300}}, "rows"), Error);
}

} // namespace
} // namespace domewarp
