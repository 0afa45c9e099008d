#include "pilotage/vision/masked_correlation.h"

#include <cmath>
#include <complex>
#include <utility>
#include <vector>

#include "match/chip_scene.h"
#include <gtest/gtest.h>

namespace pilotage {
namespace {

/// Padfield's eq. 9 summed pixel by pixel in double precision; −2 where too little overlaps, NaN where either is flat.
double correlation_at(const cv::Mat& pixels, const cv::Mat& mask, const cv::Mat& region, const cv::Mat& valid, int x,
                      int y, double needed) {
  double n = 0;
  double t = 0;
  double g = 0;
  double tt = 0;
  double gg = 0;
  double tg = 0;
  for (int row = 0; row < mask.rows; ++row) {
    for (int col = 0; col < mask.cols; ++col) {
      if (mask.at<std::uint8_t>(row, col) == 0 || valid.at<std::uint8_t>(y + row, x + col) == 0) continue;
      const double a = static_cast<double>(pixels.at<float>(row, col));
      const double b = region.at<std::uint8_t>(y + row, x + col);
      n += 1;
      t += a;
      g += b;
      tt += a * a;
      gg += b * b;
      tg += a * b;
    }
  }
  if (n < needed) return -2;
  const double norm = (tt - t * t / n) * (gg - g * g / n);
  return norm > 1e-6 ? (tg - t * g / n) / std::sqrt(norm) : std::nan("");
}

struct Pictures {
  cv::Mat pixels;  // the template, CV_32F
  cv::Mat mask;
  cv::Mat region;
  cv::Mat valid;
};

Pictures make_pictures(const std::string& name, double holes) {
  Random random(seed_from_name(name));
  Pictures p;
  p.region = testing::random_ground(47, 39, random.next());
  const RectifiedFrame frame = testing::frame_over(p.region, {22.3, 19.8}, 14, 9, 30);
  frame.gray.convertTo(p.pixels, CV_32F);
  p.mask = frame.valid;
  p.valid = cv::Mat(p.region.size(), CV_8UC1, cv::Scalar(255));
  if (holes > 0) {
    p.valid(cv::Rect(0, 0, 20, 39)).setTo(0);
    for (auto it = p.valid.begin<std::uint8_t>(); it != p.valid.end<std::uint8_t>(); ++it) {
      if (random.uniform() < holes) *it = 0;
    }
  }
  return p;
}

MaskedCorrelation correlation_of(const Pictures& p, double min_overlap) {
  return {p.mask, p.region, p.valid, min_overlap, 1e-3, opencv_sums_of_products(p.mask.size(), p.region.size())};
}

TEST(MaskedCorrelation, IsTheSumOverCommonPixels) {
  for (const double holes : {0.0, 0.15}) {
    const Pictures p = make_pictures("IsTheSumOverCommonPixels", holes);
    const double needed = 0.5 * cv::countNonZero(p.mask);
    const MaskedCorrelation correlation = correlation_of(p, 0.5);
    const cv::Mat surface = correlation.surface(p.pixels);
    ASSERT_EQ(surface.size(), cv::Size(47 - p.mask.cols + 1, 39 - p.mask.rows + 1));
    int compared = 0;
    int left_out = 0;
    for (int y = 0; y < surface.rows; ++y) {
      for (int x = 0; x < surface.cols; ++x) {
        const double expected = correlation_at(p.pixels, p.mask, p.region, p.valid, x, y, needed);
        EXPECT_NEAR(static_cast<double>(surface.at<float>(y, x)), expected, 1e-4) << x << " " << y;
        ++(expected < -1 ? left_out : compared);
      }
    }
    EXPECT_GT(compared, 50);
    EXPECT_EQ(left_out > 0, holes > 0);
  }
}

// Two channels are complex numbers: Re Σ conj(t − mean t)·(g − mean g), summed pixel by pixel.
double complex_correlation_at(const cv::Mat& t, const cv::Mat& mask, const cv::Mat& g, const cv::Mat& valid, int x,
                              int y, double needed) {
  std::vector<std::pair<std::complex<double>, std::complex<double>>> pairs;
  std::complex<double> t_mean;
  std::complex<double> g_mean;
  for (int row = 0; row < mask.rows; ++row) {
    for (int col = 0; col < mask.cols; ++col) {
      if (mask.at<std::uint8_t>(row, col) == 0 || valid.at<std::uint8_t>(y + row, x + col) == 0) continue;
      const cv::Vec2f a = t.at<cv::Vec2f>(row, col);
      const cv::Vec2f b = g.at<cv::Vec2f>(y + row, x + col);
      pairs.emplace_back(std::complex<double>(a[0], a[1]), std::complex<double>(b[0], b[1]));
      t_mean += pairs.back().first;
      g_mean += pairs.back().second;
    }
  }
  const auto n = static_cast<double>(pairs.size());
  if (n < needed) return -2;
  double product = 0;
  double tt = 0;
  double gg = 0;
  for (const auto& [a, b] : pairs) {
    product += (std::conj(a - t_mean / n) * (b - g_mean / n)).real();
    tt += std::norm(a - t_mean / n);
    gg += std::norm(b - g_mean / n);
  }
  return product / std::sqrt(tt * gg);
}

TEST(MaskedCorrelation, OfTwoChannelsIsThatOfComplexNumbers) {
  for (const double holes : {0.0, 0.15}) {
    const Pictures p = make_pictures("OfTwoChannels", holes);
    Random random(seed_from_name("OfTwoChannels"));
    cv::Mat t(p.mask.size(), CV_32FC2);
    cv::Mat g(p.valid.size(), CV_32FC2);
    for (cv::Mat* z : {&t, &g}) {
      for (auto it = z->begin<cv::Vec2f>(); it != z->end<cv::Vec2f>(); ++it) {
        *it = {static_cast<float>(random.uniform(-0.5, 1)), static_cast<float>(random.uniform(-1, 0.8))};
      }
    }
    const cv::Point place(g.cols - t.cols - 3, g.rows - t.rows - 2);
    g(cv::Rect(place, t.size())) += t;
    const MaskedCorrelation correlation(p.mask, g, p.valid, 0.5, 1e-3, opencv_sums_of_products(t.size(), g.size()));
    const cv::Mat surface = correlation.surface(t);
    const double needed = 0.5 * cv::countNonZero(p.mask);
    for (int y = 0; y < surface.rows; ++y) {
      for (int x = 0; x < surface.cols; ++x) {
        EXPECT_NEAR(static_cast<double>(surface.at<float>(y, x)),
                    complex_correlation_at(t, p.mask, g, p.valid, x, y, needed), 1e-4)
            << x << " " << y;
      }
    }
    cv::Point peak;
    cv::minMaxLoc(surface, nullptr, nullptr, nullptr, &peak);
    EXPECT_EQ(peak, place);
  }
}

TEST(MaskedCorrelation, DoesNotLookOutsideTheMasks) {
  Pictures p = make_pictures("DoesNotLookOutsideTheMasks", 0.1);
  const cv::Mat before = correlation_of(p, 0.3).surface(p.pixels);
  p.pixels.setTo(1e4, p.mask == 0);
  p.region.setTo(255, p.valid == 0);
  const cv::Mat after = correlation_of(p, 0.3).surface(p.pixels);
  EXPECT_LT(cv::norm(before, after, cv::NORM_INF), 1e-4);
}

TEST(MaskedCorrelation, FlatGroundCorrelatesWithNothing) {
  Pictures p = make_pictures("FlatGroundCorrelatesWithNothing", 0);
  const cv::Mat flat(p.pixels.size(), CV_32F, cv::Scalar(77));
  const cv::Mat of_flat_template = correlation_of(p, 0.5).surface(flat);
  EXPECT_EQ(cv::norm(of_flat_template, cv::NORM_INF), 0);
  p.region.setTo(13);
  const cv::Mat of_flat_region = correlation_of(p, 0.5).surface(p.pixels);
  EXPECT_EQ(cv::norm(of_flat_region, cv::NORM_INF), 0);
}

}  // namespace
}  // namespace pilotage
