#include "landmark/dlib_detector.h"

#include <algorithm>

// As landmark/fhog_training.cc includes dlib.
#include <dlib/assert.h>
#undef DLIB_USE_BLAS
#undef DLIB_USE_LAPACK
#define DLIB_TEST_FOR_ODR_VIOLATIONS_H_
#include <dlib/image_processing.h>
#include <dlib/opencv/cv_image.h>
#include <dlib/opencv/to_open_cv.h>

namespace pilotage::testing {
namespace {

using Scanner = dlib::scan_fhog_pyramid<dlib::pyramid_down<6>>;

dlib::array2d<unsigned char> dlib_image(const cv::Mat& gray) {
  dlib::array2d<unsigned char> image;
  dlib::assign_image(image, dlib::cv_image<unsigned char>(gray));
  return image;
}

}  // namespace

std::vector<cv::Mat> fhog_by_dlib(const cv::Mat& gray, int cell_px) {
  dlib::array<dlib::array2d<float>> planes;
  dlib::extract_fhog_features(dlib_image(gray), planes, cell_px);
  std::vector<cv::Mat> copies;
  for (const dlib::array2d<float>& plane : planes)
    copies.push_back(dlib::toMat(const_cast<dlib::array2d<float>&>(plane)).clone());
  return copies;
}

cv::Mat pyramid_down_by_dlib(const cv::Mat& gray) {
  dlib::array2d<unsigned char> down;
  dlib::pyramid_down<6>()(dlib_image(gray), down);
  return dlib::toMat(down).clone();
}

std::vector<DlibHit> detect_by_dlib(const std::vector<float>& filter, const FhogWindow& window, const cv::Mat& gray,
                                    double least_score) {
  Scanner scanner;
  const auto side = static_cast<unsigned long>(window.side_px);
  scanner.set_cell_size(static_cast<unsigned long>(window.cell_px));
  scanner.set_padding(1);
  scanner.set_detection_window_size(side, side);
  scanner.set_max_pyramid_levels(static_cast<unsigned long>(window.levels));
  scanner.set_min_pyramid_layer_size(side, side);
  dlib::matrix<double, 0, 1> weights(static_cast<long>(filter.size()));
  std::copy(filter.begin(), filter.end(), weights.begin());
  dlib::object_detector<Scanner> detector(scanner, dlib::test_box_overlap(0.5, 1.0), weights);
  std::vector<dlib::rect_detection> found;
  detector(dlib_image(gray), found, least_score);
  std::vector<DlibHit> hits;
  for (const dlib::rect_detection& one : found) {
    const auto width = static_cast<double>(one.rect.width());
    hits.push_back({{static_cast<double>(one.rect.left()) + width / 2,
                     static_cast<double>(one.rect.top()) + static_cast<double>(one.rect.height()) / 2},
                    width,
                    one.detection_confidence});
  }
  return hits;
}

}  // namespace pilotage::testing
