#pragma once

#include <array>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "pilotage/vision/fhog.h"

namespace pilotage::testing {

/// dlib's features of a picture: kFhogPlanes pictures, CV_32FC1, of the cells that have all their neighbours.
std::vector<cv::Mat> fhog_by_dlib(const cv::Mat& gray, int cell_px);

/// dlib's next smaller picture.
cv::Mat pyramid_down_by_dlib(const cv::Mat& gray);

/// What dlib's detector saw.
struct DlibHit {
  Eigen::Vector2d center_px{0, 0};
  double side_px = 0;
  double score = 0;
};

/// Hits of dlib's detector with one filter, strongest first; of hits that cover each other by half the strongest.
std::vector<DlibHit> detect_by_dlib(const std::vector<float>& filter, const FhogWindow& window, const cv::Mat& gray,
                                    double least_score);

}  // namespace pilotage::testing
