#pragma once

#include <cstddef>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "pilotage/vision/fhog.h"

namespace pilotage {

/// A detector of one class of landmarks on north-up pictures.
struct LandmarkDetector {
  std::string class_name;
  double gsd_m = 0;  ///< Of the pictures that it looks at.
  FhogWindow window;
  /// Side of the window over the length of the landmark in it.
  double context = 0;
  Eigen::Vector2d offset{0, 0};  ///< Of hits from landmarks, right and down, in sides of the window; taken off.
  double period_deg = 0;         ///< Headings that differ by it look alike; 0: every heading looks alike.
  /// filters[i] finds landmarks whose longer side heads i · period_deg / filters.size() clockwise from grid north. Each
  /// has window.filter_size() numbers.
  std::vector<std::vector<float>> filters;
  double threshold = 0;   ///< Hits of a smaller score are none.
  double shortest_m = 0;  ///< Of the landmarks that it learnt.
  double longest_m = 0;
};

/// What is wrong with a detector, or "".
std::string landmark_detector_problem(const LandmarkDetector& detector);

/// A landmark that was detected.
struct LandmarkHit {
  Eigen::Vector2d center_px{0, 0};  ///< On the picture.
  double length_px = 0;
  double score = 0;        ///< Above its filter's own threshold where positive.
  double heading_deg = 0;  ///< Clockwise from the top of the picture; NaN where headings look alike.
};

/// A hit belongs to a landmark whose middle is nearer than this part of its length.
inline constexpr double kSamePlace = 0.5;

/// Landmarks on a north-up picture (CV_8UC1) of `gsd_m` whose score is at least `least_score`, strongest first, at most
/// `most_hits`; of hits at one place (kSamePlace of the longer) the strongest alone. The picture is resampled to the
/// detector's own pixels; one of fewer than three cells shows nothing. A hit is a cell whose score none of its eight
/// neighbours exceeds; parabolas through the scores beside it place it within the cell. Of a picture the 20,000
/// strongest such cells count. Throws UsageError for a detector with a problem and a gsd_m that is not positive, and
/// what `checkpoint` throws, which is called every few milliseconds.
std::vector<LandmarkHit> detect_landmarks(const LandmarkDetector& detector, const cv::Mat& gray, double gsd_m,
                                          double least_score,
                                          std::size_t most_hits = std::numeric_limits<std::size_t>::max(),
                                          const std::function<void()>& checkpoint = {});

}  // namespace pilotage
