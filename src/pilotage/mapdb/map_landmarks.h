#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "pilotage/geo/geodetic_point.h"
#include "pilotage/mapdb/sqlite.h"
#include "pilotage/vision/landmark_detector.h"

namespace pilotage {

/// A detector and what it is worth, measured on imagery of another date than it learnt.
struct MapDetector {
  LandmarkDetector detector;
  double p_detect = 0;              ///< Share of the landmarks that it found.
  double false_alarms_per_km2 = 0;  ///< Hits that are no landmark.
  double sigma_m = 0;               ///< Of what hits miss landmarks by, each axis: the upper end of its 95 % interval.
};

/// A landmark of a class that a detector finds.
struct MapLandmark {
  std::int64_t id = 0;
  std::size_t detector = 0;  ///< Of MapLandmarks::detectors.
  GeodeticPoint place;
  double length_m = 0;
  double ground_height_m = 0;  ///< Above mean sea level; NaN where unknown.
  bool found = false;          ///< On the other date.
  double ambiguity = 0;        ///< Expected hits of its class near it that are not it; NaN where not known.
};

/// What a map holds of landmarks.
struct MapLandmarks {
  std::vector<MapDetector> detectors;  ///< By class, each once.
  std::vector<MapLandmark> landmarks;  ///< Ascending id.
};

inline constexpr std::size_t kMaxMapDetectors = 64;
inline constexpr std::size_t kMaxMapLandmarks = 100'000;
/// Of all filters together, as a reader holds them.
inline constexpr std::size_t kMaxFilterBytes = std::size_t{16} << 20;
inline constexpr double kLargestLandmarkSigma_m = 10;

/// What is wrong with the numbers of detectors and landmarks, their classes and the size of their filters, or "".
std::string map_landmarks_problem(const MapLandmarks& landmarks);

/// What is wrong with a detector or a landmark, or "".
std::string detector_problem(const MapDetector& detector);
std::string landmark_problem(const MapLandmark& landmark, std::size_t detectors);

/// The columns that read_landmarks expects in pilotage_detectors and landmarks.
inline constexpr std::string_view kDetectorColumns =
    "id, class, gsd_m, window_px, cell_px, levels, context, offset_x, offset_y, period_deg, threshold, shortest_m, "
    "longest_m, p_detect, false_alarms_per_km2, sigma_m, filters";
inline constexpr std::string_view kLandmarkColumns =
    "fid, detector, lon_deg, lat_deg, length_m, ground_height_m, found, ambiguity";

/// Both tables of a map that has them. Throws DataError beginning with the file's name.
MapLandmarks read_landmarks(const Database& database);

/// Filters as they are stored: numbers of 32 bits, little-endian, one filter after the other.
std::vector<std::uint8_t> filter_bytes(const LandmarkDetector& detector);

}  // namespace pilotage
