#include <array>
#include <cmath>
#include <complex>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/random.h"
#include "pilotage/correlation/correlation_kernels.h"
#include "pilotage/correlation/fft_correlation.h"
#include "pilotage/vision/masked_correlation.h"

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
  EXPECT_EQ(fast_fft_size(513), 540);
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

/// One formula, two libraries' transforms: both agree with the direct sums, and with each other to the last digits.
TEST(MaskedCorrelation, IsTheSameByFftwAndByOpenCv) {
  const cv::Mat region = ground(120, 140, "BothTransforms");
  cv::Mat region_valid(region.size(), CV_8U, cv::Scalar(255));
  region_valid(cv::Rect(0, 60, 70, 60)).setTo(0);
  for (int i = 0; i < 300; ++i) region_valid.at<std::uint8_t>((i * 53) % 120, (i * 97) % 140) = 0;
  const cv::Rect where(40, 30, 48, 40);
  const cv::Mat tile_valid = region_valid(where).clone();
  const cv::Mat by_fftw = masked_surfaces(tile_valid, region, region_valid, 0.4)(region(where));
  const MaskedCorrelation by_opencv(tile_valid, region, region_valid, 0.4, 0,
                                    opencv_sums_of_products(tile_valid.size(), region.size()));
  const cv::Mat other = by_opencv.surface(region(where));
  for (int row = 0; row < other.rows; ++row) {
    for (int col = 0; col < other.cols; ++col) {
      const float expected = masked_oracle(region(where), tile_valid, region, region_valid, col, row, 0.4);
      ASSERT_EQ(other.at<float>(row, col) == MaskedCorrelation::kNotCompared, std::isnan(expected));
      ASSERT_EQ(std::isnan(by_fftw.at<float>(row, col)), std::isnan(expected));
      if (std::isnan(expected)) continue;
      ASSERT_NEAR(by_fftw.at<float>(row, col), expected, 1e-6) << col << ", " << row;
      ASSERT_NEAR(other.at<float>(row, col), expected, 1e-6) << col << ", " << row;
    }
  }
}

TEST(MaskedCorrelation, WithoutHolesIsTheOrdinaryOne) {
  const cv::Mat region = ground(60, 64, "WithoutHoles");
  const cv::Mat valid(region.size(), CV_8U, cv::Scalar(1));
  const cv::Rect where(10, 20, 20, 30);
  const cv::Mat masked = masked_correlation_surface(region(where), valid(where), region, valid, 0.5);
  EXPECT_LT(cv::norm(masked, correlation_surface(region(where), region), cv::NORM_INF), 1e-3);
}

/// What take_apart() gives, pixel by pixel.
std::vector<cv::Mat> components(const cv::Mat& image, int lag_step) {
  std::vector<cv::Mat> result;
  for (int i = 0; i < lag_step; ++i) {
    for (int j = 0; j < lag_step; ++j) {
      cv::Mat component((image.rows + lag_step - 1 - i) / lag_step, (image.cols + lag_step - 1 - j) / lag_step, CV_32F);
      for (int row = 0; row < component.rows; ++row) {
        for (int col = 0; col < component.cols; ++col) {
          component.at<float>(row, col) = image.at<float>(lag_step * row + i, lag_step * col + j);
        }
      }
      result.push_back(component);
    }
  }
  return result;
}

TEST(TakeApart, PutsEachPixelIntoItsComponent) {
  const cv::Mat image = ground(11, 14, "TakeApart");
  for (const int step : {1, 2, 4}) {
    std::vector<cv::Mat> parts;
    take_apart(image, step, parts);
    const std::vector<cv::Mat> expected = components(image, step);
    ASSERT_EQ(parts.size(), expected.size());
    for (std::size_t i = 0; i < parts.size(); ++i) {
      ASSERT_EQ(parts[i].size(), expected[i].size());
      EXPECT_EQ(cv::norm(parts[i], expected[i], cv::NORM_INF), 0);
    }
  }
  std::vector<cv::Mat> parts;
  EXPECT_THROW(take_apart(image, 3, parts), UsageError);
}

struct Blocks {
  int block;
  int radius;
  int stride;
  int lag_step;
};

/// Two blocks at one place against plain sums, for radii that make one, two and four windows a side, and steps of the
/// lags that divide sizes or do not.
TEST(BlockCorrelator, AgreesWithDirectSums) {
  for (const Blocks& sizes : {Blocks{8, 5, 8, 1}, Blocks{8, 16, 8, 1}, Blocks{4, 32, 4, 1}, Blocks{16, 8, 16, 1},
                              Blocks{7, 3, 2, 1}, Blocks{16, 32, 16, 2}, Blocks{15, 9, 4, 2}, Blocks{16, 64, 16, 4},
                              Blocks{18, 13, 9, 4}, Blocks{16, 64, 5, 2}}) {
    const BlockCorrelator correlator(sizes.block, sizes.radius, sizes.stride, sizes.lag_step);
    const int step = sizes.lag_step;
    const int reach = correlator.radius_px();
    ASSERT_EQ(reach, sizes.radius / step * step);
    const cv::Mat map = ground(sizes.block + 2 * reach + step, sizes.block + 2 * reach + step, "BlockCorrelator") - 110;
    const cv::Mat block = map(cv::Rect(reach, reach, sizes.block, sizes.block));
    const cv::Mat other = ground(sizes.block, sizes.block, "other") - 110;
    std::vector<RealFft2d::Workspace> workspaces;
    std::vector<AlignedFloats> own;
    std::vector<const float*> spectra;
    std::vector<cv::Mat> surfaces;
    const int side = 2 * correlator.radius() + 1;
    for (const cv::Mat& pixels : {block, other}) {
      workspaces.push_back(correlator.make_workspace());
      own.emplace_back(correlator.spectrum_size());
      correlator.forward(components(pixels, step), workspaces.back(), own.back().data());
      surfaces.emplace_back(side, side, CV_32F);
    }
    for (const AlignedFloats& spectrum : own) spectra.push_back(spectrum.data());
    std::vector<AlignedFloats> windows;
    std::vector<const float*> pointers;
    for (int row = 0; row < correlator.windows_per_side(); ++row) {
      for (int col = 0; col < correlator.windows_per_side(); ++col) {
        windows.emplace_back(correlator.spectrum_size());
        const cv::Rect window(col * correlator.hop_px(), row * correlator.hop_px(), correlator.window_px(),
                              correlator.window_px());
        correlator.forward(components(map(window), step), workspaces[0], windows.back().data());
      }
    }
    for (const AlignedFloats& window : windows) pointers.push_back(window.data());
    correlator.correlate(spectra, pointers, {0, side}, workspaces, surfaces);
    for (int row = 0; row < side; ++row) {
      for (int col = 0; col < side; ++col) {
        const cv::Mat there = map(cv::Rect(step * col, step * row, sizes.block, sizes.block));
        const double bound = 2e-6 * sizes.block * sizes.block * 1e3;
        ASSERT_NEAR(surfaces[0].at<float>(row, col) / correlator.scale(), block.dot(there), bound)
            << sizes.block << ' ' << sizes.radius << ' ' << step << ": " << col << ", " << row;
        ASSERT_NEAR(surfaces[1].at<float>(row, col) / correlator.scale(), other.dot(there), bound);
      }
    }
  }
  EXPECT_EQ(BlockCorrelator(7, 3, 2).windows_per_side(), 1);
  EXPECT_GT(BlockCorrelator(64, 256, 64).windows_per_side(), 1);
  EXPECT_GT(BlockCorrelator(64, 256, 64, 4).windows_per_side(), 1);
  EXPECT_THROW(BlockCorrelator(64, 256, 64, 3), UsageError);
  EXPECT_THROW(BlockCorrelator(64, 256, 64, 0), UsageError);
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
    for (const std::size_t step : {1U, 2U, 4U}) {
      const std::size_t values = (count + step - 1) / step;
      std::vector<float> ncc(in[2].begin(), in[2].begin() + static_cast<std::ptrdiff_t>(values));
      normalise(in[0].data(), in[1].data(), step, 0.5F, 1.5F, values, ncc.data());
      for (std::size_t i = 0; i < values; ++i) {
        EXPECT_EQ(ncc[i], std::clamp((in[2][i] - 0.5F * in[0][step * i]) * (1.5F * in[1][step * i]), -1.0F, 1.0F));
      }
    }
    double total = 0;
    float highest = -2;
    for (std::size_t i = 0; i < count; ++i) {
      EXPECT_EQ(out[i], ((in[0][i] + in[1][i]) + in[2][i]) + in[3][i]);
      EXPECT_EQ(sum[i], in[0][i] + in[1][i]);
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

  for (const std::size_t terms : {1U, 2U, 3U, 16U}) {
    constexpr std::size_t kCount = 8;
    std::vector<float> a(2 * kCount * terms);
    std::vector<float> b(2 * kCount * terms);
    std::vector<float> product(2 * kCount);
    for (float& value : a) value = static_cast<float>(random.normal());
    for (float& value : b) value = static_cast<float>(random.normal());
    multiply_conjugate_sum(a.data(), b.data(), terms, kCount, product.data());
    for (std::size_t i = 0; i < 2 * kCount; i += 2) {
      std::complex<double> expected;
      for (std::size_t j = i; j < a.size(); j += 2 * kCount) {
        expected += std::conj(std::complex<double>(a[j], a[j + 1])) * std::complex<double>(b[j], b[j + 1]);
      }
      EXPECT_NEAR(product[i], expected.real(), 1e-5);
      EXPECT_NEAR(product[i + 1], expected.imag(), 1e-5);
    }
  }
}

TEST(CorrelationKernels, ProductsWithNineNeighbours) {
  const cv::Mat image = ground(20, 40, "nine");
  for (const int width : {1, 7, 8, 19, 38}) {
    std::array<double, 9> sums{};
    for (int row = 0; row < 5; ++row) {
      const std::array<const float*, 3> map{image.ptr<float>(row), image.ptr<float>(row + 1),
                                            image.ptr<float>(row + 2)};
      add_products_3x3(image.ptr<float>(10 + row) + 1, map.data(), static_cast<std::size_t>(width), sums.data());
    }
    for (int k = 0; k < 9; ++k) {
      const double expected = image(cv::Rect(1, 10, width, 5)).dot(image(cv::Rect(k % 3, k / 3, width, 5)));
      EXPECT_NEAR(sums[static_cast<std::size_t>(k)], expected, 1e-6 * expected);
    }
  }
}

}  // namespace
}  // namespace pilotage
