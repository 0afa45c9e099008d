#include "pilotage/correlation/correlation_peaks.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/random.h"

namespace pilotage {
namespace {

void add_gaussian(cv::Mat& surface, cv::Point2d center, double height, double sigma) {
  for (int row = 0; row < surface.rows; ++row) {
    for (int col = 0; col < surface.cols; ++col) {
      const double d2 = (col - center.x) * (col - center.x) + (row - center.y) * (row - center.y);
      surface.at<float>(row, col) += static_cast<float>(height * std::exp(-d2 / (2 * sigma * sigma)));
    }
  }
}

TEST(CorrelationPeaks, TellsPeakAndRivalsApart) {
  cv::Mat surface = cv::Mat::zeros(129, 129, CV_32F);
  add_gaussian(surface, {64, 60}, 0.9, 2);
  add_gaussian(surface, {100, 30}, 0.6, 2);
  add_gaussian(surface, {20, 110}, 0.75, 2);
  add_gaussian(surface, {110, 110}, 0.73, 2);
  const CorrelationPeaks peaks = correlation_peaks(surface, {64, 60}, 256);
  EXPECT_NEAR(peaks.peak, 0.9, 1e-6);
  EXPECT_NEAR(peaks.rival, 0.75, 1e-6);
  EXPECT_NEAR(peaks.margin, 0.15, 1e-6);
  EXPECT_NEAR(peaks.rival_ratio, 0.75 / 0.9, 1e-6);
  EXPECT_EQ(peaks.rivals, 2);  // 0.75 and 0.73 exceed 0.72, 0.6 does not
  EXPECT_EQ(peaks.rival_dx_px, -44);
  EXPECT_EQ(peaks.rival_dy_px, 50);
  // A Gaussian falls to half its height at sigma·sqrt(2 ln 2).
  EXPECT_NEAR(peaks.half_width_px, 2 * std::sqrt(2 * std::numbers::ln2), 0.25);
}

/// PSR against sums over everything outside the square that hides the main lobe.
TEST(CorrelationPeaks, PsrIsThatOfTheRestOfTheSurface) {
  Random random(seed_from_name("Psr"));
  cv::Mat surface(81, 93, CV_32F);
  for (int row = 0; row < surface.rows; ++row) {
    for (int col = 0; col < surface.cols; ++col) {
      surface.at<float>(row, col) = static_cast<float>(0.05 + 0.1 * random.normal());
    }
  }
  surface.at<float>(40, 50) = 0.95F;  // a single pixel: lobe of reach 0, two pixels hidden on each side
  surface.at<float>(40, 52) = 0.9F;   // inside
  surface.at<float>(40, 53) = 0.8F;   // outside
  double sum = 0;
  double squares = 0;
  int count = 0;
  for (int row = 0; row < surface.rows; ++row) {
    for (int col = 0; col < surface.cols; ++col) {
      if (std::abs(row - 40) <= 2 && std::abs(col - 50) <= 2) continue;
      sum += static_cast<double>(surface.at<float>(row, col));
      squares += std::pow(static_cast<double>(surface.at<float>(row, col)), 2);
      ++count;
    }
  }
  const double mean = sum / count;
  const CorrelationPeaks peaks = correlation_peaks(surface, {50, 40}, 64);
  EXPECT_NEAR(peaks.psr, (surface.at<float>(40, 50) - mean) / std::sqrt(squares / count - mean * mean), 1e-4);
  EXPECT_FLOAT_EQ(static_cast<float>(peaks.rival), 0.8F);
  EXPECT_EQ(peaks.rival_dx_px, 3);
}

/// The bound by hand: a Gaussian lobe of height ρ has second differences 2ρ(1 − e^(−1/2s²)).
TEST(CorrelationPeaks, ExpectedErrorFollowsTheFormula) {
  for (const double rho : {0.3, 0.6}) {
    cv::Mat surface = cv::Mat::zeros(101, 101, CV_32F);
    add_gaussian(surface, {50, 50}, rho, 3);
    const CorrelationPeaks peaks = correlation_peaks(surface, {50, 50}, 128);
    const double curvature = 2 * rho * (1 - std::exp(-1.0 / 18));
    const double area = std::numbers::pi * peaks.half_width_px * peaks.half_width_px;
    const double samples = 128 * 128 / area;
    EXPECT_NEAR(peaks.expected_error_px, std::sqrt((1 - rho * rho) / (rho * samples) / curvature),
                1e-3 * peaks.expected_error_px);
  }
}

TEST(CorrelationPeaks, SharperPeakPromisesSmallerError) {
  double last = 0;
  for (const double sigma : {1.0, 2.0, 4.0}) {
    cv::Mat surface = cv::Mat::zeros(101, 101, CV_32F);
    add_gaussian(surface, {50, 50}, 0.7, sigma);
    const double error = correlation_peaks(surface, {50, 50}, 256).expected_error_px;
    EXPECT_GT(error, last);
    last = error;
  }
}

TEST(CorrelationPeaks, ExcludedPositionsDoNotCount) {
  cv::Mat surface(40, 40, CV_32F, cv::Scalar(0.1));
  surface.at<float>(5, 5) = 0.9F;
  surface.at<float>(30, 30) = 0.5F;
  surface(cv::Rect(25, 25, 10, 10)).setTo(std::numeric_limits<float>::quiet_NaN());
  const CorrelationPeaks peaks = correlation_peaks(surface, {5, 5}, 32);
  EXPECT_FLOAT_EQ(static_cast<float>(peaks.rival), 0.1F);
  EXPECT_TRUE(std::isnan(correlation_peaks(surface, {30, 30}, 32).peak));
  EXPECT_TRUE(std::isnan(correlation_peaks(surface, {30, 30}, 32).margin));
}

TEST(CorrelationPeaks, LostPeakHasANegativeMargin) {
  cv::Mat surface = cv::Mat::zeros(41, 41, CV_32F);
  surface.at<float>(20, 20) = -0.2F;
  surface.at<float>(3, 3) = 0.4F;
  const CorrelationPeaks peaks = correlation_peaks(surface, {20, 20}, 64);
  EXPECT_NEAR(peaks.margin, -0.6, 1e-6);
  EXPECT_TRUE(std::isnan(peaks.rival_ratio));
  EXPECT_TRUE(std::isnan(peaks.rivals));
  EXPECT_TRUE(std::isnan(peaks.half_width_px));
  EXPECT_TRUE(std::isnan(peaks.expected_error_px));
}

TEST(CorrelationPeaks, TinySurfaceHasNoRival) {
  const cv::Mat surface(3, 3, CV_32F, cv::Scalar(1));
  const CorrelationPeaks peaks = correlation_peaks(surface, {1, 1}, 16);
  EXPECT_EQ(peaks.peak, 1);
  EXPECT_TRUE(std::isnan(peaks.rival));
  EXPECT_TRUE(std::isnan(peaks.margin));
}

TEST(CorrelationPeaks, RefusesAPositionOutside) {
  const cv::Mat surface(3, 3, CV_32F, cv::Scalar(1));
  EXPECT_THROW(correlation_peaks(surface, {3, 1}, 16), UsageError);
  EXPECT_THROW(correlation_peaks(cv::Mat(3, 3, CV_64F), {1, 1}, 16), UsageError);
}

/// A part of a whole surface, as sparse_correlation_peaks() takes it.
SparseSurface part_of(const cv::Mat& surface, const cv::Point& truth, int step, int tile_size_px) {
  const int radius = near_radius_px(tile_size_px);
  const cv::Rect near = cv::Rect(truth.x - radius, truth.y - radius, 2 * radius + 1, 2 * radius + 1) &
                        cv::Rect(0, 0, surface.cols, surface.rows);
  SparseSurface part;
  part.step = step;
  part.near = surface(near).clone();
  part.near_truth = truth - near.tl();
  part.lattice_truth = {truth.x / step, truth.y / step};
  const cv::Point first = truth - step * part.lattice_truth;
  part.lattice.create((surface.rows - 1 - first.y) / step + 1, (surface.cols - 1 - first.x) / step + 1, CV_32F);
  for (int row = 0; row < part.lattice.rows; ++row) {
    for (int col = 0; col < part.lattice.cols; ++col) {
      part.lattice.at<float>(row, col) = surface.at<float>(first.y + step * row, first.x + step * col);
    }
  }
  return part;
}

ValuesAround values_of(const cv::Mat& surface, const cv::Point& truth, int& asked) {
  return [&surface, truth, &asked](const cv::Point& lag) {
    ++asked;
    std::vector<SurfaceValue> values;
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        const cv::Point at = truth + lag + cv::Point(dx, dy);
        if (!cv::Rect(0, 0, surface.cols, surface.rows).contains(at)) continue;
        values.push_back({at - truth, surface.at<float>(at)});
      }
    }
    return values;
  };
}

/// A rival that stands between the positions of the lattice is found at its own place and height.
TEST(SparseCorrelationPeaks, FindsTheRivalBetweenThePositions) {
  for (const int step : {2, 4}) {
    for (const cv::Point rival : {cv::Point(101, 31), cv::Point(99, 30), cv::Point(20, 113), cv::Point(102, 98)}) {
      cv::Mat surface = cv::Mat::zeros(129, 131, CV_32F);
      add_gaussian(surface, {64, 60}, 0.9, 4);
      add_gaussian(surface, rival, 0.6, 4);
      add_gaussian(surface, {100, 66}, 0.59, 4);  // on the lattice
      const cv::Point truth(64, 60);
      int asked = 0;
      const auto sparse =
          sparse_correlation_peaks(part_of(surface, truth, step, 64), 64, values_of(surface, truth, asked));
      const CorrelationPeaks all = correlation_peaks(surface, truth, 64);
      ASSERT_TRUE(sparse);
      EXPECT_EQ(sparse->peak, all.peak);
      EXPECT_EQ(sparse->half_width_px, all.half_width_px);
      EXPECT_EQ(sparse->expected_error_px, all.expected_error_px);
      EXPECT_EQ(sparse->rival, all.rival) << step << ": " << rival;
      EXPECT_EQ(sparse->rival_dx_px, rival.x - truth.x);
      EXPECT_EQ(sparse->rival_dy_px, rival.y - truth.y);
      EXPECT_EQ(sparse->margin, all.margin);
      EXPECT_NEAR(sparse->psr, all.psr, 0.05 * all.psr);  // σ is that of a few peaks on nothing
      EXPECT_GT(asked, 0);
      EXPECT_LT(asked, 20);
    }
  }
}

TEST(SparseCorrelationPeaks, CountsRivalsByTheirHeight) {
  cv::Mat surface = cv::Mat::zeros(129, 129, CV_32F);
  add_gaussian(surface, {64, 64}, 0.9, 4);
  for (const cv::Point at : {cv::Point(20, 20), cv::Point(105, 23), cv::Point(23, 105)}) {
    add_gaussian(surface, at, 0.75, 4);
  }
  add_gaussian(surface, {107, 107}, 0.65, 4);
  int asked = 0;
  const auto sparse =
      sparse_correlation_peaks(part_of(surface, {64, 64}, 4, 64), 64, values_of(surface, {64, 64}, asked));
  ASSERT_TRUE(sparse);
  EXPECT_EQ(sparse->rivals, 3);
}

/// Ground so sharp that a peak fits between the positions is left to the plain way.
TEST(SparseCorrelationPeaks, RefusesSharpGround) {
  cv::Mat surface = cv::Mat::zeros(129, 129, CV_32F);
  add_gaussian(surface, {64, 64}, 1, 1);
  int asked = 0;
  const ValuesAround around = values_of(surface, {64, 64}, asked);
  EXPECT_FALSE(sparse_correlation_peaks(part_of(surface, {64, 64}, 2, 64), 64, around));
  EXPECT_FALSE(sparse_correlation_peaks(part_of(surface, {64, 64}, 4, 64), 64, around));
  EXPECT_FALSE(sparse_correlation_peaks(part_of(-surface, {64, 64}, 4, 64), 64, around));
}

}  // namespace
}  // namespace pilotage
