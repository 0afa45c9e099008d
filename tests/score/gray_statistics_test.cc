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
       {gray_statistics(gray, all_valid(gray)), PowerSums(gray, all_valid(gray)).at({0, 0, 2, 2})}) {
    expect_near_relative(statistics.gray_variance, 124.00268814290546L, 1e-12, "V");
    expect_near_relative(statistics.frieden_entropy, 1.0628529611060606L, 1e-12, "H");
  }
}

TEST(GrayStatistics, WindowsOfAnySizeAreAsPrinted8Bit) {
  const cv::Mat gray = random_image<std::uint8_t>(300, 260, CV_8U, 0, 256, "8bit");
  cv::Mat valid = all_valid(gray);
  valid(cv::Rect(40, 40, 30, 7)).setTo(0);
  const PowerSums sums(gray, valid);
  for (const int side : {2, 3, 8, 31, 64, 100, 256}) {
    for (const cv::Point corner : {cv::Point(0, 0), cv::Point(3, 44), cv::Point(1, 39)}) {
      const cv::Rect window(corner.x, corner.y, side, side);
      expect_as_printed<std::uint8_t>(gray(window), valid(window), sums.at(window));
      expect_as_printed<std::uint8_t>(gray(window), valid(window), gray_statistics(gray(window), valid(window)));
    }
  }
}

TEST(GrayStatistics, WindowsOfAnySizeAreAsPrinted16Bit) {
  for (const double low : {0.0, 60000.0}) {
    const cv::Mat gray = random_image<std::uint16_t>(140, 150, CV_16U, low, 65535, "16bit");
    const PowerSums sums(gray, all_valid(gray));
    for (const int side : {2, 5, 40, 128}) {
      const cv::Rect window(7, 9, side, side);
      expect_as_printed<std::uint16_t>(gray(window), all_valid(gray(window)), sums.at(window));
    }
  }
}

TEST(GrayStatistics, WindowsOfAnySizeAreAsPrintedDouble) {
  for (const double scale : {1e-300, 1.0, 1e150, 1e300}) {
    const cv::Mat gray = random_image<double>(70, 64, CV_64F, 0.1 * scale, 3 * scale, "double");
    const PowerSums sums(gray, all_valid(gray));
    for (const int side : {2, 9, 64}) {
      const cv::Rect window(0, 3, side, side);
      const GrayStatistics statistics = sums.at(window);
      expect_as_printed<double>(gray(window), all_valid(gray(window)), statistics);
    }
  }
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
  const GrayStatistics fast = PowerSums(gray, all_valid(gray)).at({0, 0, 256, 256});
  const GrayStatistics slow = gray_statistics(gray, all_valid(gray));
  expect_near_relative(fast.frieden_deficit, static_cast<long double>(slow.frieden_deficit), 1e-9, "deficit");
  // (σ/f̄)² − 1/(2N) to leading order.
  const double n = 65536;
  const double ratio = slow.gray_variance * slow.gray_variance * (n - 1) / n / (slow.mean * slow.mean);
  EXPECT_NEAR(slow.frieden_deficit, ratio - 1 / (2 * n), 1e-9);
}

TEST(GrayStatistics, FlatTileHasNoVariance) {
  const cv::Mat bytes(50, 40, CV_8U, cv::Scalar(77));
  EXPECT_EQ(PowerSums(bytes, all_valid(bytes)).at({0, 0, 40, 50}).gray_variance, 0);
  const cv::Mat doubles(50, 40, CV_64F, cv::Scalar(0.1));
  EXPECT_EQ(gray_statistics(doubles, all_valid(doubles)).gray_variance, 0);
  EXPECT_NEAR(gray_statistics(doubles, all_valid(doubles)).frieden_entropy, std::exp(1 - 1 / 2000.0), 1e-14);
}

TEST(GrayStatistics, UndefinedIsNaN) {
  const cv::Mat black(4, 4, CV_8U, cv::Scalar(0));
  const GrayStatistics none = PowerSums(black, all_valid(black)).at({0, 0, 4, 4});
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
  EXPECT_TRUE(std::isnan(PowerSums(black, all_valid(black)).at({1, 1, 1, 1}).gray_variance));
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
  EXPECT_THROW(PowerSums(gray, cv::Mat(4, 5, CV_8U)), UsageError);
  EXPECT_THROW(PowerSums(cv::Mat(4, 4, CV_32S), all_valid(gray)), UsageError);
}

}  // namespace
}  // namespace pilotage
