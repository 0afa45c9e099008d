#pragma once

#include <vector>

#include <opencv2/core/mat.hpp>

#include "pilotage/vision/fhog.h"

namespace pilotage {

/// A picture to learn from. Everything that lies in none of the squares is learnt as background.
struct TrainingPicture {
  cv::Mat gray;                 ///< CV_8U.
  std::vector<cv::Rect> boxes;  ///< What is to be found; squares.
  std::vector<cv::Rect> ignored;
};

struct TrainingOptions {
  double c = 10;          ///< Weight of errors against a flat filter.
  double epsilon = 0.05;  ///< The cutting-plane solver stops when its bound is that near, in loss a picture.
};

struct TrainedFilter {
  std::vector<float> weights;  ///< FhogWindow::filter_size() of them.
  int unobtainable = 0;        ///< Boxes that no place of the window covers by half: left out.
};

/// The linear filter that finds the boxes and nothing else, by a structural support vector machine with margin rescaled
/// by missed boxes and false alarms (D. King, "Max-margin object detection", arXiv:1502.00046, 2015), as dlib trains
/// it; one thread, so that the same pictures give the same bits. Throws DataError when no box can be obtained.
TrainedFilter train_fhog(const std::vector<TrainingPicture>& pictures, const FhogWindow& window,
                         const TrainingOptions& options);

}  // namespace pilotage
