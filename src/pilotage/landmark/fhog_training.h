#pragma once

#include <vector>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

namespace pilotage {

/// A copy of a picture, and what is seen on it, over the next smaller one.
inline constexpr double kFhogPyramidStep = 6.0 / 5.0;

/// How a detector looks at a picture: a square window slides over cells of gradient histograms (fHOG) of the picture
/// and of smaller copies of it, each 5/6 of the one before.
struct FhogWindow {
  int side_px = 45;  ///< An odd number of cells: of an even one the middle lies half a cell beside the hit.
  int cell_px = 5;
  int levels = 1;  ///< Pictures that are looked at: it and levels − 1 copies.
};

/// A picture to learn from. Everything that lies in none of the squares is learnt as background.
struct TrainingPicture {
  cv::Mat gray;                 ///< CV_8U.
  std::vector<cv::Rect> boxes;  ///< What is to be found; squares.
  std::vector<cv::Rect> ignored;
};

struct TrainingOptions {
  double c = 10;          ///< Weight of errors against a flat filter.
  double epsilon = 0.01;  ///< The cutting-plane solver stops when its bound is that near, in loss a picture.
};

struct TrainedFilter {
  std::vector<double> weights;  ///< Of the window's cells, plane by plane as dlib has them, then the threshold.
  int unobtainable = 0;         ///< Boxes that no place of the window covers by half: left out.
};

/// The linear filter that finds the boxes and nothing else, by a structural support vector machine with margin rescaled
/// by missed boxes and false alarms (D. King, "Max-margin object detection", arXiv:1502.00046, 2015), as dlib trains
/// it; one thread, so that the same pictures give the same bits. Throws DataError when no box can be obtained.
TrainedFilter train_fhog(const std::vector<TrainingPicture>& pictures, const FhogWindow& window,
                         const TrainingOptions& options);

/// What a detector saw.
struct FhogHit {
  Eigen::Vector2d center_px{0, 0};
  double side_px = 0;
  double score = 0;        ///< Above the filter's own threshold where positive.
  std::size_t filter = 0;  ///< Which of them.
};

/// Hits of dlib's detector with these filters, all of one window, whose score is at least `least_score`, strongest
/// first; of hits that cover each other by half the strongest alone.
std::vector<FhogHit> detect_by_dlib(const std::vector<std::vector<double>>& filters, const FhogWindow& window,
                                    const cv::Mat& gray, double least_score);

}  // namespace pilotage
