#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "pilotage/base/statistics.h"
#include "pilotage/geo/geodetic_point.h"
#include "pilotage/vision/landmark_detector.h"

namespace pilotage {

/// How well a detector finds landmarks of places that it was not trained on: each block of ground is left out once.
struct LandmarkQuality {
  int blocks = 0;
  double average_precision = 0;  ///< Area under precision over recall; NaN without a label.
  Share recall;                  ///< At the threshold that the other blocks give.
  Share precision;               ///< At the same; of none when nothing was found.
};

/// A detector, where it learnt, and what it is worth.
struct LearntDetector {
  LandmarkDetector detector;
  std::vector<GeodeticPoint> places;  ///< Of the landmarks that it learnt.
  LandmarkQuality quality;
};

struct LandmarkModel {
  std::vector<LearntDetector> detectors;  ///< By class.
};

/// A model as JSON (schemas/landmark_model.schema.json), with the digest of its content.
nlohmann::ordered_json landmark_model_to_json(const LandmarkModel& model);

/// Throws DataError naming the file and what is wrong; IntegrityError when its content is not that of its digest.
LandmarkModel read_landmark_model(const std::filesystem::path& path);

}  // namespace pilotage
