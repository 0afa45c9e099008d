#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace pilotage {
struct MapLandmarks;
}  // namespace pilotage

#pragma GCC visibility push(default)

namespace pilotage {

/// The landmarks of a class, and what its detector is worth.
struct LandmarkClass {
  std::string name;
  std::int64_t landmarks = 0;
  double p_detect = 0;  ///< As MapDetector has them, and the next two.
  double false_alarms_per_km2 = 0;
  double sigma_m = 0;
};

/// What is worth saying: a fix by landmarks that comes more often than not.
inline constexpr double kLeastLandmarkGain = 0.5;

/// In the order of the detectors.
std::vector<LandmarkClass> landmark_classes(const MapLandmarks& landmarks);

/// "76 landmarks of 3 classes (ring, roundabout and tank)".
std::string landmarks_phrase(const std::vector<LandmarkClass>& classes);

/// What P of a fix by landmarks (landmark_prospects.h) takes for granted: it is not counted in "the verdict", a frame's
/// place is known "as the limit allows". `unresolved`: classes that are not counted.
std::string landmark_assumption(const std::string& answer, const std::string& place,
                                const std::vector<std::string>& unresolved);

/// "0.97": rounded down; "below 0.01" of what is more than 0.
std::string landmark_p_text(double p);

/// A table to unfold.
std::string landmark_classes_html(const std::vector<LandmarkClass>& classes);

/// As it stands in report.json and survey.json.
nlohmann::ordered_json landmark_classes_json(const std::vector<LandmarkClass>& classes);

}  // namespace pilotage

#pragma GCC visibility pop
