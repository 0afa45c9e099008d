#include <cmath>
#include <complex>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/random.h"
#include "pilotage/vision/correlation_kernels.h"
#include "pilotage/vision/fft_correlation.h"

namespace pilotage {
namespace {

/// Smooth ground with grain, like an orthophoto: gray levels around 110.
cv::Mat ground(int rows, int cols, std::string_view name) {
  Random random(seed_from_name(name));
  cv::Mat image(rows, cols, CV_32F);
  for (int row = 0; row < rows; ++row) {
    for (int col = 0; col < cols; ++col) image.at<float>(row, col) = static_cast<float>(random.normal());
  }
  cv::Mat coarse;
  cv::GaussianBlur(image, coarse, {0, 0}, 6);
  cv::Mat result = 110 + 250 * coarse + 8 * image;
  cv::Mat bytes;
  result.convertTo(bytes, CV_8U);
  bytes.convertTo(result, CV_32F);
  return result;
}

TEST(FastFftSize, IsTheNextProductOfSmallPrimes) {
  EXPECT_EQ(fast_fft_size(1), 1);
  EXPECT_EQ(fast_fft_size(11), 12);
  EXPECT_EQ(fast_fft_size(320), 320);
  EXPECT_EQ(fast_fft_size(513), 525);
}

TEST(CorrelationSurface, AgreesWithMatchTemplate) {
  const cv::Mat region = ground(150, 190, "CorrelationSurface");
  for (const cv::Rect tile : {cv::Rect(30, 20, 64, 64), cv::Rect(0, 0, 17, 40), cv::Rect(61, 3, 129, 147)}) {
    cv::Mat expected;
    cv::matchTemplate(region, region(tile), expected, cv::TM_CCOEFF_NORMED);
    const cv::Mat surface = correlation_surface(region(tile), region);
    ASSERT_EQ(surface.size(), expected.size());
    EXPECT_LT(cv::norm(surface, expected, cv::NORM_INF), 1e-4);
    EXPECT_NEAR(surface.at<float>(tile.tl()), 1, 1e-5);
  }
}

TEST(CorrelationSurface, FlatIsZero) {
  cv::Mat region = ground(60, 60, "FlatIsZero");
  region(cv::Rect(30, 30, 30, 30)).setTo(90);
  const cv::Mat surface = correlation_surface(region(cv::Rect(0, 0, 16, 16)), region);
  EXPECT_EQ(surface.at<float>(35, 35), 0);
  EXPECT_EQ(cv::countNonZero(correlation_surface(region(cv::Rect(35, 35, 16, 16)), region)), 0);
}

TEST(CorrelationSurface, RefusesATileThatDoesNotFit) {
  EXPECT_THROW(correlation_surface(ground(8, 9, "a"), ground(8, 8, "b")), UsageError);
}

/// The sums over the pixels that are valid in both, as Padfield's eq. 9 says.
float masked_oracle(const cv::Mat& tile, const cv::Mat& tile_valid, const cv::Mat& region, const cv::Mat& region_valid,
                    int col, int row, double min_overlap) {
  double n = 0, t = 0, g = 0, tt = 0, gg = 0, tg = 0;
  for (int y = 0; y < tile.rows; ++y) {
    for (int x = 0; x < tile.cols; ++x) {
      if (tile_valid.at<std::uint8_t>(y, x) == 0 || region_valid.at<std::uint8_t>(row + y, col + x) == 0) continue;
      const double a = tile.at<float>(y, x);
      const double b = region.at<float>(row + y, col + x);
      n += 1;
      t += a;
      g += b;
      tt += a * a;
      gg += b * b;
      tg += a * b;
    }
  }
  if (n < std::max(2.0, min_overlap * cv::countNonZero(tile_valid))) return std::numeric_limits<float>::quiet_NaN();
  return static_cast<float>((tg - t * g / n) / std::sqrt((tt - t * t / n) * (gg - g * g / n)));
}

TEST(MaskedCorrelation, AgreesWithDirectSums) {
  const cv::Mat region = ground(70, 80, "MaskedCorrelation");
  cv::Mat region_valid(region.size(), CV_8U, cv::Scalar(255));
  region_valid(cv::Rect(0, 40, 50, 30)).setTo(0);
  region_valid(cv::Rect(60, 5, 5, 9)).setTo(0);
  cv::Mat garbage = region.clone();  // what is not valid must not matter
  garbage.setTo(1e4, region_valid == 0);
  const cv::Rect where(20, 25, 24, 24);
  const cv::Mat surface = masked_correlation_surface(garbage(where), region_valid(where), garbage, region_valid, 0.4);
  int excluded = 0;
  for (int row = 0; row < surface.rows; ++row) {
    for (int col = 0; col < surface.cols; ++col) {
      const float expected = masked_oracle(region(where), region_valid(where), region, region_valid, col, row, 0.4);
      const float value = surface.at<float>(row, col);
      if (std::isnan(expected)) ++excluded;
      ASSERT_EQ(std::isnan(value), std::isnan(expected)) << col << ", " << row;
      if (!std::isnan(expected)) {
        ASSERT_NEAR(value, expected, 1e-3) << col << ", " << row;
      }
    }
  }
  EXPECT_GT(excluded, 10);
  EXPECT_NEAR(surface.at<float>(where.tl()), 1, 1e-3);
}

TEST(MaskedCorrelation, WithoutHolesIsTheOrdinaryOne) {
  const cv::Mat region = ground(60, 64, "WithoutHoles");
  const cv::Mat valid(region.size(), CV_8U, cv::Scalar(1));
  const cv::Rect where(10, 20, 20, 30);
  const cv::Mat masked = masked_correlation_surface(region(where), valid(where), region, valid, 0.5);
  EXPECT_LT(cv::norm(masked, correlation_surface(region(where), region), cv::NORM_INF), 1e-3);
}

/// Blocks against plain sums, for radii that make one, two and four windows a side.
TEST(BlockCorrelator, AgreesWithDirectSums) {
  for (const auto& [block, radius, stride] :
       {std::tuple(8, 5, 8), std::tuple(8, 16, 8), std::tuple(4, 32, 4), std::tuple(16, 8, 16), std::tuple(7, 3, 2)}) {
    const BlockCorrelator correlator(block, radius, stride);
    const cv::Mat map = ground(block + 2 * radius, block + 2 * radius, "BlockCorrelator") - 110;
    auto workspace = correlator.make_workspace();
    AlignedFloats own(correlator.spectrum_size());
    correlator.forward(map(cv::Rect(radius, radius, block, block)), workspace, own.data());
    std::vector<AlignedFloats> windows;
    std::vector<const float*> pointers;
    for (int row = 0; row < correlator.windows_per_side(); ++row) {
      for (int col = 0; col < correlator.windows_per_side(); ++col) {
        windows.emplace_back(correlator.spectrum_size());
        const int side = correlator.window_px();
        correlator.forward(map(cv::Rect(col * correlator.hop_px(), row * correlator.hop_px(), side, side)), workspace,
                           windows.back().data());
      }
    }
    for (const AlignedFloats& window : windows) pointers.push_back(window.data());
    cv::Mat surface(2 * radius + 1, 2 * radius + 1, CV_32F);
    correlator.correlate(own.data(), pointers, {0, 2 * radius + 1}, workspace, surface);
    for (int row = 0; row <= 2 * radius; ++row) {
      for (int col = 0; col <= 2 * radius; ++col) {
        const double expected = map(cv::Rect(radius, radius, block, block)).dot(map(cv::Rect(col, row, block, block)));
        ASSERT_NEAR(surface.at<float>(row, col) / correlator.scale(), expected, 2e-6 * block * block * 1e3)
            << block << ' ' << radius << ": " << col << ", " << row;
      }
    }
  }
  EXPECT_EQ(BlockCorrelator(7, 3, 2).windows_per_side(), 1);
  EXPECT_GT(BlockCorrelator(64, 256, 64).windows_per_side(), 1);
}

TEST(CorrelationKernels, AgreeWithPlainLoops) {
  Random random(seed_from_name("CorrelationKernels"));
  for (const std::size_t count : {1U, 7U, 8U, 15U, 16U, 33U, 513U}) {
    std::vector<std::vector<float>> in(4, std::vector<float>(count));
    for (auto& values : in) {
      for (float& value : values) value = static_cast<float>(random.uniform(-1, 1));
    }
    std::vector<float> out(count);
    add_four(in[0].data(), in[1].data(), in[2].data(), in[3].data(), count, out.data());
    std::vector<float> sum = in[0];
    add_to(in[1].data(), count, sum.data());
    std::vector<float> ncc = in[2];
    normalise(in[0].data(), in[1].data(), 0.5F, 1.5F, count, ncc.data());
    double total = 0;
    float highest = -2;
    for (std::size_t i = 0; i < count; ++i) {
      EXPECT_EQ(out[i], ((in[0][i] + in[1][i]) + in[2][i]) + in[3][i]);
      EXPECT_EQ(sum[i], in[0][i] + in[1][i]);
      EXPECT_EQ(ncc[i], std::clamp((in[2][i] - 0.5F * in[0][i]) * (1.5F * in[1][i]), -1.0F, 1.0F));
      if (i == 3) in[0][i] = std::numeric_limits<float>::quiet_NaN();
      if (i == 3) continue;
      total += in[0][i];
      highest = std::max(highest, in[0][i]);
    }
    const SpanSums sums = sum_span(in[0].data(), count);
    EXPECT_EQ(sums.count, static_cast<double>(count > 3 ? count - 1 : count));
    EXPECT_NEAR(sums.sum, total, 1e-5 * static_cast<double>(count));
    EXPECT_EQ(sums.highest, highest);
  }
  EXPECT_EQ(sum_span(nullptr, 0).count, 0);

  std::vector<float> a(16);
  std::vector<float> b(16);
  std::vector<float> product(16);
  for (std::size_t i = 0; i < 16; ++i) a[i] = static_cast<float>(random.normal());
  for (std::size_t i = 0; i < 16; ++i) b[i] = static_cast<float>(random.normal());
  multiply_conjugate(a.data(), b.data(), 8, product.data());
  for (std::size_t i = 0; i < 16; i += 2) {
    const std::complex<float> expected =
        std::conj(std::complex<float>(a[i], a[i + 1])) * std::complex<float>(b[i], b[i + 1]);
    EXPECT_NEAR(product[i], expected.real(), 1e-6);
    EXPECT_NEAR(product[i + 1], expected.imag(), 1e-6);
  }
}

}  // namespace
}  // namespace pilotage
