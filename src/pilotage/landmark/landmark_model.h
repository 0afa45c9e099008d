#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "pilotage/base/statistics.h"
#include "pilotage/geo/geodetic_point.h"
#include "pilotage/landmark/fhog_training.h"

namespace pilotage {

/// How well a detector finds landmarks of places that it was not trained on: each block of ground is left out once.
struct LandmarkQuality {
  int blocks = 0;
  double average_precision = 0;  ///< Area under precision over recall; NaN without a label.
  Share recall;                  ///< At the threshold that the other blocks give.
  Share precision;               ///< At the same; of none when nothing was found.
};

/// A detector of one class of landmarks on north-up pictures.
struct LandmarkDetector {
  std::string class_name;
  double gsd_m = 0;  ///< Of the pictures that it looks at.
  FhogWindow window;
  /// Side of the window over the length of the landmark in it.
  double context = 0;
  Eigen::Vector2d offset{0, 0};  ///< Of hits from landmarks, right and down, in sides of the window; taken off.
  double period_deg = 0;         ///< Headings that differ by it look alike; 0: every heading looks alike.
  /// filters[i] finds landmarks whose longer side heads i · period_deg / filters.size() clockwise from grid north.
  std::vector<std::vector<double>> filters;
  double threshold = 0;   ///< Hits of a smaller score are none.
  double shortest_m = 0;  ///< Of the landmarks that it learnt.
  double longest_m = 0;
  std::vector<GeodeticPoint> learnt;  ///< Their places.
  LandmarkQuality quality;
};

struct LandmarkModel {
  std::vector<LandmarkDetector> detectors;  ///< By class.
};

/// A landmark that was detected.
struct LandmarkHit {
  Eigen::Vector2d center_px{0, 0};  ///< On the picture.
  double length_px = 0;
  double score = 0;
  double heading_deg = 0;  ///< Clockwise from the top of the picture; NaN where headings look alike.
};

/// A hit belongs to a landmark whose middle is nearer than this part of its length.
inline constexpr double kSamePlace = 0.5;

/// Landmarks on a north-up picture (CV_8U) of `gsd_m` whose score is at least `least_score`, strongest first; of hits
/// at one place (kSamePlace of the longer) the strongest alone. The picture is resampled to the detector's own pixels.
std::vector<LandmarkHit> detect_landmarks(const LandmarkDetector& detector, const cv::Mat& gray, double gsd_m,
                                          double least_score);

/// A model as JSON (schemas/landmark_model.schema.json), with the digest of its content.
nlohmann::ordered_json landmark_model_to_json(const LandmarkModel& model);

/// Throws DataError naming the file and what is wrong; IntegrityError when its content is not that of its digest.
LandmarkModel read_landmark_model(const std::filesystem::path& path);

}  // namespace pilotage
