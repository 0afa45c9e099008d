#include "pilotage/vision/picture_spectra.h"

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "pilotage/base/random.h"

namespace pilotage {
namespace {

cv::Mat random_pixels(int width, int height, Random& random) {
  cv::Mat pixels(height, width, CV_32F);
  for (auto it = pixels.begin<float>(); it != pixels.end<float>(); ++it) *it = static_cast<float>(random.normal());
  return pixels;
}

TEST(PictureSpectra, ProductsAreSumsAtEveryPosition) {
  Random random(3);
  const cv::Mat large = random_pixels(37, 29, random);
  const cv::Mat small[] = {random_pixels(7, 5, random), random_pixels(7, 5, random)};
  const PictureSpectra spectra(large.size());
  cv::Mat sum;
  for (const cv::Mat& one : small) {
    const cv::Mat product = PictureSpectra::product(spectra.spectrum(large), spectra.spectrum(one));
    sum = sum.empty() ? product : cv::Mat(sum + product);
  }
  const cv::Rect inner(2, 3, 29, 22);
  const cv::Mat found = PictureSpectra::pixels(sum, inner);
  ASSERT_EQ(found.size(), inner.size());
  for (int y = 0; y < inner.height; ++y) {
    for (int x = 0; x < inner.width; ++x) {
      const cv::Mat under = large(cv::Rect(x + inner.x, y + inner.y, 7, 5));
      ASSERT_NEAR(found.at<float>(y, x), under.dot(small[0]) + under.dot(small[1]), 1e-4) << x << " " << y;
    }
  }
}

}  // namespace
}  // namespace pilotage
