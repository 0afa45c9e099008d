#include "pilotage/mapdb/map_landmarks.h"

#include <bit>
#include <cmath>
#include <set>
#include <string_view>

#include "pilotage/base/error.h"
#include "pilotage/base/nan.h"
#include "pilotage/base/text.h"
#include "pilotage/mapdb/byte_order.h"

namespace pilotage {
namespace {

double real_or_nan(const Statement& statement, int column) {
  return statement.is_null(column) ? kNaN : statement.real(column);
}

MapDetector read_detector_row(const Statement& row, const std::string& where) {
  MapDetector read;
  LandmarkDetector& detector = read.detector;
  detector.class_name = row.text(1);
  detector.gsd_m = row.real(2);
  const int side_px = row.integer(3, 1, 1 << 20);
  const int cell_px = row.integer(4, 1, 1 << 20);
  detector.window = {side_px, cell_px, row.integer(5, 1, 1 << 20)};
  detector.context = row.real(6);
  const double offset_x = row.real(7);
  detector.offset = {offset_x, row.real(8)};
  detector.period_deg = row.real(9);
  detector.threshold = row.real(10);
  detector.shortest_m = row.real(11);
  detector.longest_m = row.real(12);
  read.p_detect = row.real(13);
  read.false_alarms_per_km2 = row.real(14);
  read.sigma_m = row.real(15);
  const std::string window = fhog_window_problem(detector.window);
  if (!window.empty()) throw DataError(where + ": " + window);
  const std::span<const std::uint8_t> bytes = row.blob(16);
  const std::size_t filter_length = 4 * detector.window.filter_size();
  if (bytes.empty() || bytes.size() % filter_length != 0) {
    throw DataError(where + ": filters has " + std::to_string(bytes.size()) + " bytes, a filter " +
                    std::to_string(filter_length));
  }
  for (std::size_t at = 0; at < bytes.size(); at += filter_length) {
    std::vector<float>& filter = detector.filters.emplace_back();
    for (std::size_t i = 0; i < filter_length; i += 4) {
      filter.push_back(std::bit_cast<float>(read_le<std::uint32_t>(bytes.data() + at + i)));
    }
  }
  const std::string problem = detector_problem(read);
  if (!problem.empty()) throw DataError(where + ": " + problem);
  return read;
}

}  // namespace

std::string map_landmarks_problem(const MapLandmarks& landmarks) {
  const auto too_many = [](std::size_t count, std::size_t most, const char* what) {
    return count > most ? std::to_string(count) + " " + what + ", a map has at most " + std::to_string(most)
                        : std::string();
  };
  std::string problem = too_many(landmarks.detectors.size(), kMaxMapDetectors, "detectors");
  if (problem.empty()) problem = too_many(landmarks.landmarks.size(), kMaxMapLandmarks, "landmarks");
  std::set<std::string> classes;
  std::size_t bytes = 0;
  for (const MapDetector& one : landmarks.detectors) {
    if (problem.empty() && !classes.insert(one.detector.class_name).second) {
      problem = "two detectors of the class " + one.detector.class_name;
    }
    bytes += one.detector.filters.size() * one.detector.window.filter_size() * sizeof(float);
  }
  if (problem.empty()) problem = too_many(bytes, kMaxFilterBytes, "bytes of filters");
  return problem;
}

std::string detector_problem(const MapDetector& detector) {
  const std::string problem = landmark_detector_problem(detector.detector);
  if (!problem.empty()) return problem;
  if (!(detector.p_detect >= 0 && detector.p_detect <= 1)) {
    return "p_detect = " + format_number(detector.p_detect) + " is outside [0, 1]";
  }
  if (!(detector.false_alarms_per_km2 >= 0 && std::isfinite(detector.false_alarms_per_km2))) {
    return "false_alarms_per_km2 = " + format_number(detector.false_alarms_per_km2) + " is no number from 0";
  }
  if (!(detector.sigma_m > 0 && detector.sigma_m <= kLargestLandmarkSigma_m)) {
    return "sigma_m = " + format_number(detector.sigma_m) + " is outside (0, " +
           format_number(kLargestLandmarkSigma_m) + "]";
  }
  return {};
}

std::string landmark_problem(const MapLandmark& landmark, std::size_t detectors) {
  if (landmark.detector >= detectors) return "there is no detector " + std::to_string(landmark.detector);
  if (!(std::abs(landmark.place.lon_deg) <= 180 && std::abs(landmark.place.lat_deg) <= 90)) {
    return "(lon " + format_number(landmark.place.lon_deg) + ", lat " + format_number(landmark.place.lat_deg) +
           ") is not on Earth";
  }
  if (!(landmark.length_m > 0 && landmark.length_m <= 1e5)) {
    return "length_m = " + format_number(landmark.length_m) + " is outside (0, 100000]";
  }
  if (std::isinf(landmark.ground_height_m) || std::abs(landmark.ground_height_m) > 1e5) {
    return "ground_height_m = " + format_number(landmark.ground_height_m) + " is no height on Earth";
  }
  if (!std::isnan(landmark.ambiguity) && !(landmark.ambiguity >= 0 && std::isfinite(landmark.ambiguity))) {
    return "ambiguity = " + format_number(landmark.ambiguity) + " is no number from 0";
  }
  return {};
}

MapLandmarks read_landmarks(const Database& database) {
  MapLandmarks read;
  Statement detectors = database.prepare(
      "SELECT " + std::string(kDetectorColumns) + " FROM pilotage_detectors ORDER BY id", "pilotage_detectors");
  while (detectors.step()) {
    const std::string where =
        database.name() + ": pilotage_detectors: detector " + std::to_string(detectors.integer(0));
    if (detectors.integer(0) != std::ssize(read.detectors)) throw DataError(where + ": detectors count from 0");
    read.detectors.push_back(read_detector_row(detectors, where));
    // Before the next is read: what a forged map holds may be large.
    const std::string problem = map_landmarks_problem(read);
    if (!problem.empty()) throw DataError(where + ": " + problem);
  }
  Statement landmarks =
      database.prepare("SELECT " + std::string(kLandmarkColumns) + " FROM landmarks ORDER BY fid", "landmarks");
  while (landmarks.step()) {
    MapLandmark landmark;
    landmark.id = landmarks.integer(0);
    const std::string where = database.name() + ": landmarks: landmark " + std::to_string(landmark.id);
    if (read.landmarks.size() == kMaxMapLandmarks) {
      throw DataError(where + ": a map has at most " + std::to_string(kMaxMapLandmarks) + " landmarks");
    }
    landmark.detector = static_cast<std::size_t>(landmarks.integer(1, 0, static_cast<int>(kMaxMapDetectors)));
    const double lon_deg = landmarks.real(2);
    landmark.place = {lon_deg, landmarks.real(3)};
    landmark.length_m = landmarks.real(4);
    landmark.ground_height_m = real_or_nan(landmarks, 5);
    landmark.found = landmarks.integer(6, 0, 1) == 1;
    landmark.ambiguity = real_or_nan(landmarks, 7);
    const std::string problem = landmark_problem(landmark, read.detectors.size());
    if (!problem.empty()) throw DataError(where + ": " + problem);
    read.landmarks.push_back(landmark);
  }
  return read;
}

std::vector<std::uint8_t> filter_bytes(const LandmarkDetector& detector) {
  std::vector<std::uint8_t> bytes;
  for (const std::vector<float>& filter : detector.filters) {
    for (const float number : filter) append_le(bytes, number);
  }
  return bytes;
}

}  // namespace pilotage
