#include "pilotage/score/gray_statistics.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/random.h"

namespace pilotage {
namespace {

cv::Mat all_valid(const cv::Mat& gray) {
  return {gray.size(), CV_8U, cv::Scalar(255)};
}

template <class T>
cv::Mat random_image(int rows, int cols, int type, double low, double high, std::string_view name) {
  Random random(seed_from_name(name));
  cv::Mat image(rows, cols, type);
  for (int row = 0; row < rows; ++row) {
    for (int col = 0; col < cols; ++col) image.at<T>(row, col) = static_cast<T>(random.uniform(low, high));
  }
  return image;
}

/// The formulas as printed, in quadruple-like long double, without any of the rearrangements under test.
struct Printed {
  long double variance = 0;
  long double entropy = 0;
  long double deficit = 0;
};

template <class T>
Printed printed(const cv::Mat& gray, const cv::Mat& valid) {
  long double n = 0;
  long double sum = 0;
  const auto each = [&](auto&& function) {
    for (int row = 0; row < gray.rows; ++row) {
      for (int col = 0; col < gray.cols; ++col) {
        if (valid.at<std::uint8_t>(row, col) != 0) function(static_cast<long double>(gray.at<T>(row, col)));
      }
    }
  };
  each([&](long double f) {
    n += 1;
    sum += f;
  });
  Printed result;
  each([&](long double f) {
    result.variance += (f - sum / n) * (f - sum / n);
    result.entropy += f / sum * std::exp(1 - f / sum);
  });
  result.variance = std::sqrt(result.variance / (n - 1));
  result.deficit = n * (1 - result.entropy / std::numbers::e_v<long double>)-1;
  return result;
}

void expect_near_relative(double value, long double expected, double relative, const char* what) {
  EXPECT_LE(std::abs(static_cast<long double>(value) - expected), relative * std::abs(expected))
      << what << ": " << value << " instead of " << static_cast<double>(expected);
}

template <class T>
void expect_as_printed(const cv::Mat& gray, const cv::Mat& valid, const GrayStatistics& statistics) {
  const Printed expected = printed<T>(gray, valid);
  EXPECT_EQ(statistics.count, cv::countNonZero(valid));
  expect_near_relative(statistics.gray_variance, expected.variance, 1e-11, "V");
  expect_near_relative(statistics.frieden_entropy, expected.entropy, 1e-11, "H");
  // The printed form of the deficit loses digits to cancellation, about N·1e-19 in long double.
  EXPECT_NEAR(statistics.frieden_deficit, static_cast<double>(expected.deficit),
              1e-10 * std::abs(static_cast<double>(expected.deficit)) + 1e-17 * gray.rows * gray.cols);
}

/// numpy: f = np.array([[1, 2], [3, 250]]); V = f.std(ddof=1); p = f / f.sum(); H = (p * np.exp(1 - p)).sum()
TEST(GrayStatistics, AgreesWithNumpyOnAHandMadeTile) {
  const cv::Mat gray = (cv::Mat_<std::uint8_t>(2, 2) << 1, 2, 3, 250);
  for (const GrayStatistics& statistics :
       {gray_statistics(gray, all_valid(gray)), WindowSums(gray, all_valid(gray), 2, 1).at(0, 0)}) {
    expect_near_relative(statistics.gray_variance, 124.00268814290546L, 1e-12, "V");
    expect_near_relative(statistics.frieden_entropy, 1.0628529611060606L, 1e-12, "H");
  }
}

/// One window of an image.
GrayStatistics from_sums(const cv::Mat& gray, const cv::Mat& valid) {
  return WindowSums(gray, valid, gray.cols, 1).at(0, 0);
}

TEST(GrayStatistics, WindowsOfAnySizeAreAsPrinted8Bit) {
  const cv::Mat gray = random_image<std::uint8_t>(300, 260, CV_8U, 0, 256, "8bit");
  cv::Mat valid = all_valid(gray);
  valid(cv::Rect(40, 40, 30, 7)).setTo(0);
  for (const int side : {2, 3, 8, 31, 64, 100, 256}) {
    for (const cv::Point corner : {cv::Point(0, 0), cv::Point(3, 44), cv::Point(1, 39)}) {
      const cv::Rect window(corner.x, corner.y, side, side);
      expect_as_printed<std::uint8_t>(gray(window), valid(window), from_sums(gray(window), valid(window)));
      expect_as_printed<std::uint8_t>(gray(window), valid(window), gray_statistics(gray(window), valid(window)));
    }
  }
}

TEST(GrayStatistics, WindowsOfAnySizeAreAsPrinted16Bit) {
  for (const double low : {0.0, 60000.0}) {
    const cv::Mat gray = random_image<std::uint16_t>(140, 150, CV_16U, low, 65535, "16bit");
    for (const int side : {2, 5, 40, 128}) {
      const cv::Rect window(7, 9, side, side);
      expect_as_printed<std::uint16_t>(gray(window), all_valid(gray(window)),
                                       from_sums(gray(window), all_valid(gray(window))));
    }
  }
}

TEST(GrayStatistics, WindowsOfAnySizeAreAsPrintedDouble) {
  for (const double scale : {1e-300, 1.0, 1e150, 1e300}) {
    const cv::Mat gray = random_image<double>(70, 64, CV_64F, 0.1 * scale, 3 * scale, "double");
    for (const int side : {2, 9, 64}) {
      const cv::Rect window(0, 3, side, side);
      const GrayStatistics statistics = from_sums(gray(window), all_valid(gray(window)));
      expect_as_printed<double>(gray(window), all_valid(gray(window)), statistics);
    }
  }
}

/// Every window of a grid, for sides and strides with and without a common divisor.
void expect_grid_as_oracle(const cv::Mat& gray, const cv::Mat& valid) {
  for (const auto& [side, stride] : {std::pair{64, 16}, {48, 36}, {50, 7}, {40, 64}, {33, 1}}) {
    const WindowSums sums(gray, valid, side, stride);
    const WindowSums by_three(gray, valid, side, stride, 3);
    ASSERT_EQ(sums.columns(), (gray.cols - side) / stride + 1);
    ASSERT_EQ(sums.rows(), (gray.rows - side) / stride + 1);
    for (std::int64_t row = 0; row < sums.rows(); row += stride == 1 ? 11 : 1) {
      for (std::int64_t column = 0; column < sums.columns(); column += stride == 1 ? 13 : 1) {
        const cv::Rect window(static_cast<int>(column) * stride, static_cast<int>(row) * stride, side, side);
        const GrayStatistics fast = sums.at(column, row);
        const GrayStatistics oracle = gray_statistics(gray(window), valid(window));
        ASSERT_EQ(fast.count, oracle.count);
        expect_near_relative(fast.gray_variance, static_cast<long double>(oracle.gray_variance), 1e-11, "V");
        expect_near_relative(fast.frieden_entropy, static_cast<long double>(oracle.frieden_entropy), 1e-11, "H");
        expect_near_relative(fast.frieden_deficit, static_cast<long double>(oracle.frieden_deficit), 1e-9, "deficit");
        EXPECT_EQ(fast.frieden_deficit, by_three.at(column, row).frieden_deficit);
        EXPECT_EQ(fast.frieden_deficit, from_sums(gray(window), valid(window)).frieden_deficit);  // pixels alone decide
      }
    }
  }
}

TEST(GrayStatistics, GridsOfWindowsAreAsTheOracle) {
  cv::Mat bytes = random_image<std::uint8_t>(150, 211, CV_8U, 0, 256, "grid 8");
  cv::Mat valid = all_valid(bytes);
  valid(cv::Rect(40, 40, 30, 27)).setTo(0);
  expect_grid_as_oracle(bytes, valid);
  const cv::Mat words = random_image<std::uint16_t>(150, 211, CV_16U, 64000, 65536, "grid 16");
  expect_grid_as_oracle(words, valid);
}

/// Cells of many pixels with the largest powers of f − 128.
TEST(GrayStatistics, LargeDarkTilesDoNotOverflow) {
  cv::Mat gray(1100, 1100, CV_8U, cv::Scalar(0));
  gray.row(600).setTo(255);
  gray.col(3).setTo(1);
  for (const auto& [side, stride] : {std::pair{1024, 1024}, {1000, 500}, {1096, 1}}) {
    const GrayStatistics fast = WindowSums(gray, all_valid(gray), side, stride).at(0, 0);
    const cv::Rect window(0, 0, side, side);
    const GrayStatistics oracle = gray_statistics(gray(window), all_valid(gray(window)));
    EXPECT_EQ(fast.count, oracle.count);
    EXPECT_EQ(fast.mean, oracle.mean);
    expect_near_relative(fast.gray_variance, static_cast<long double>(oracle.gray_variance), 1e-12, "V");
    expect_near_relative(fast.frieden_entropy, static_cast<long double>(oracle.frieden_entropy), 1e-12, "H");
    expect_near_relative(fast.frieden_deficit, static_cast<long double>(oracle.frieden_deficit), 1e-10, "deficit");
  }
}

TEST(GrayStatistics, AnImageSmallerThanTheWindowHasNone) {
  const cv::Mat gray(20, 40, CV_8U, cv::Scalar(3));
  const WindowSums sums(gray, all_valid(gray), 30, 8);
  EXPECT_EQ(sums.columns() * sums.rows(), 0);
}

/// Σf² − (Σf)²/N has no correct digit here; two passes have all.
TEST(GrayStatistics, LargeOffsetKeepsTheVariance) {
  cv::Mat gray = random_image<double>(64, 64, CV_64F, 0, 1, "offset");
  const double small = gray_statistics(gray, all_valid(gray)).gray_variance;
  cv::Mat shifted(64, 64, CV_64F);
  for (int row = 0; row < 64; ++row) {
    for (int col = 0; col < 64; ++col) {
      gray.at<double>(row, col) = std::round(gray.at<double>(row, col) * 1024) / 1024;  // exact after the shift
      shifted.at<double>(row, col) = gray.at<double>(row, col) + 1e12;
    }
  }
  EXPECT_NEAR(gray_statistics(gray, all_valid(gray)).gray_variance, small, 1e-3);
  expect_near_relative(gray_statistics(shifted, all_valid(shifted)).gray_variance,
                       static_cast<long double>(gray_statistics(gray, all_valid(gray)).gray_variance), 1e-12, "V");
}

TEST(GrayStatistics, LowContrastKeepsTheDeficit) {
  cv::Mat gray(256, 256, CV_8U, cv::Scalar(200));
  gray.at<std::uint8_t>(10, 10) = 201;
  const GrayStatistics fast = from_sums(gray, all_valid(gray));
  const GrayStatistics slow = gray_statistics(gray, all_valid(gray));
  expect_near_relative(fast.frieden_deficit, static_cast<long double>(slow.frieden_deficit), 1e-9, "deficit");
  // (σ/f̄)² − 1/(2N) to leading order.
  const double n = 65536;
  const double ratio = slow.gray_variance * slow.gray_variance * (n - 1) / n / (slow.mean * slow.mean);
  EXPECT_NEAR(slow.frieden_deficit, ratio - 1 / (2 * n), 1e-9);
}

TEST(GrayStatistics, FlatTileHasNoVariance) {
  const cv::Mat bytes(40, 40, CV_8U, cv::Scalar(77));
  EXPECT_EQ(from_sums(bytes, all_valid(bytes)).gray_variance, 0);
  const cv::Mat doubles(50, 40, CV_64F, cv::Scalar(0.1));
  EXPECT_EQ(gray_statistics(doubles, all_valid(doubles)).gray_variance, 0);
  EXPECT_NEAR(gray_statistics(doubles, all_valid(doubles)).frieden_entropy, std::exp(1 - 1 / 2000.0), 1e-14);
}

TEST(GrayStatistics, UndefinedIsNaN) {
  const cv::Mat black(4, 4, CV_8U, cv::Scalar(0));
  const GrayStatistics none = from_sums(black, all_valid(black));
  EXPECT_EQ(none.gray_variance, 0);
  EXPECT_TRUE(std::isnan(none.frieden_entropy));
  EXPECT_TRUE(std::isnan(none.frieden_deficit));

  const cv::Mat negative = (cv::Mat_<double>(1, 3) << -1, 2, 3);
  const GrayStatistics below = gray_statistics(negative, all_valid(negative));
  EXPECT_NEAR(below.gray_variance, std::sqrt(13.0 / 3), 1e-14);
  EXPECT_TRUE(std::isnan(below.frieden_entropy));

  const cv::Mat nothing(4, 4, CV_8U, cv::Scalar(0));
  EXPECT_EQ(gray_statistics(black, nothing).count, 0);
  EXPECT_TRUE(std::isnan(gray_statistics(black, nothing).gray_variance));
  EXPECT_TRUE(std::isnan(WindowSums(black, all_valid(black), 1, 1).at(2, 3).gray_variance));
}

TEST(GrayStatistics, NotFiniteIsNotValid) {
  const cv::Mat gray = (cv::Mat_<double>(1, 4) << 1, std::nan(""), 3, INFINITY);
  const GrayStatistics statistics = gray_statistics(gray, all_valid(gray));
  EXPECT_EQ(statistics.count, 2);
  EXPECT_NEAR(statistics.gray_variance, std::sqrt(2.0), 1e-15);
}

TEST(GrayStatistics, RefusesOtherImages) {
  const cv::Mat gray(4, 4, CV_8U, cv::Scalar(1));
  EXPECT_THROW(gray_statistics(cv::Mat(4, 4, CV_8UC3), all_valid(gray)), UsageError);
  EXPECT_THROW(WindowSums(gray, cv::Mat(4, 5, CV_8U), 2, 1), UsageError);
  EXPECT_THROW(WindowSums(gray, all_valid(gray), 0, 1), UsageError);
  EXPECT_THROW(WindowSums(gray, all_valid(gray), 2, 0), UsageError);
  EXPECT_THROW(WindowSums(cv::Mat(4, 4, CV_32S), all_valid(gray), 2, 1), UsageError);
}

}  // namespace
}  // namespace pilotage
