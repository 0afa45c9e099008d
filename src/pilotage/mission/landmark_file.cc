#include "pilotage/mission/landmark_file.h"

#include <algorithm>

#include <nlohmann/json.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/file_digest.h"
#include "pilotage/base/json_object.h"
#include "pilotage/base/nan.h"
#include "pilotage/base/options_json.h"
#include "pilotage/base/read_file.h"
#include "pilotage/base/utf8.h"

namespace pilotage {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kFormat = "pilotage map landmarks";
constexpr int kVersion = 1;

}  // namespace

Json detector_to_json(const LandmarkDetector& detector) {
  return {{"class", detector.class_name},
          {"gsd_m", detector.gsd_m},
          {"window_px", detector.window.side_px},
          {"cell_px", detector.window.cell_px},
          {"levels", detector.window.levels},
          {"context", detector.context},
          {"offset", {detector.offset.x(), detector.offset.y()}},
          {"period_deg", detector.period_deg},
          {"threshold", detector.threshold},
          {"shortest_m", detector.shortest_m},
          {"longest_m", detector.longest_m},
          {"filters", detector.filters}};
}

LandmarkDetector detector_from_json(JsonObject& json) {
  LandmarkDetector detector;
  detector.class_name = json.text("class");
  detector.gsd_m = json.number("gsd_m");
  detector.window.side_px = json.small_integer("window_px");
  detector.window.cell_px = json.small_integer("cell_px");
  detector.window.levels = json.small_integer("levels");
  detector.context = json.number("context");
  const std::vector<double> offset = json.numbers("offset", 2);
  detector.offset = {offset[0], offset[1]};
  detector.period_deg = json.number("period_deg");
  detector.threshold = json.number("threshold");
  detector.shortest_m = json.number("shortest_m");
  detector.longest_m = json.number("longest_m");
  for (const Json& filter : json.list("filters")) {
    if (!filter.is_array() || !std::all_of(filter.begin(), filter.end(), [](const Json& w) { return w.is_number(); })) {
      json.fail("filters", "lists of numbers");
    }
    detector.filters.push_back(filter.get<std::vector<float>>());
  }
  const std::string problem = landmark_detector_problem(detector);
  if (!problem.empty()) throw DataError(json.where() + ": " + problem);
  return detector;
}

Json digested_json(const std::string& format, int version, const Json& content) {
  Json json = {{"format", format}, {"version", version}};
  json.update(content);
  json["digest"] = bytes_digest(json_text(json, 0));
  return json;
}

Json read_digested_json(const std::filesystem::path& path, const std::string& format, int version,
                        const std::string& written_by) {
  const std::string file = name_as_utf8(path.string());
  Json content = parse_json(file, read_file(path));
  JsonObject json(content, file);
  if (!json.has("format") || json.text("format") != format) {
    throw DataError(file + ": holds no " + format.substr(format.find(' ') + 1) + "; `pilotage " + written_by +
                    "` writes one");
  }
  if (json.integer("version") != version) {
    throw DataError(file + ": is of version " + std::to_string(json.integer("version")) +
                    "; this program reads version " + std::to_string(version));
  }
  const std::string digest = json.text("digest");
  content.erase("digest");
  if (bytes_digest(json_text(content, 0)) != digest) {
    throw IntegrityError(file + ": was changed after it was written: its content has another digest");
  }
  content.erase("format");
  content.erase("version");
  return content;
}

Json map_landmarks_to_json(const MapLandmarks& landmarks) {
  Json detectors = Json::array();
  for (const MapDetector& one : landmarks.detectors) {
    Json detector = detector_to_json(one.detector);
    detector["p_detect"] = one.p_detect;
    detector["false_alarms_per_km2"] = one.false_alarms_per_km2;
    detector["sigma_m"] = one.sigma_m;
    detectors.push_back(std::move(detector));
  }
  Json places = Json::array();
  for (const MapLandmark& landmark : landmarks.landmarks) {
    places.push_back({{"class", landmarks.detectors[landmark.detector].detector.class_name},
                      {"lon_deg", landmark.place.lon_deg},
                      {"lat_deg", landmark.place.lat_deg},
                      {"length_m", landmark.length_m},
                      {"found", landmark.found},
                      {"ambiguity", json_number(landmark.ambiguity)}});
  }
  return digested_json(kFormat, kVersion, {{"detectors", detectors}, {"landmarks", places}});
}

MapLandmarks read_map_landmarks(const std::filesystem::path& path) {
  const Json content = read_digested_json(path, kFormat, kVersion, "landmark-score --for-map");
  JsonObject json(content, name_as_utf8(path.string()));
  MapLandmarks read;
  for (JsonObject& detector : json.objects("detectors")) {
    MapDetector one;
    one.detector = detector_from_json(detector);
    one.p_detect = detector.number("p_detect");
    one.false_alarms_per_km2 = detector.number("false_alarms_per_km2");
    one.sigma_m = detector.number("sigma_m");
    detector.finish();
    const std::string problem = detector_problem(one);
    if (!problem.empty()) throw DataError(detector.where() + ": " + problem);
    read.detectors.push_back(std::move(one));
  }
  for (JsonObject& place : json.objects("landmarks")) {
    MapLandmark landmark;
    landmark.id = std::ssize(read.landmarks);
    const std::string class_name = place.text("class");
    const auto detector = std::find_if(read.detectors.begin(), read.detectors.end(),
                                       [&](const MapDetector& one) { return one.detector.class_name == class_name; });
    if (detector == read.detectors.end()) {
      throw DataError(place.where() + ": there is no detector of the class " + class_name);
    }
    landmark.detector = static_cast<std::size_t>(detector - read.detectors.begin());
    const double lon_deg = place.number("lon_deg");
    landmark.place = {lon_deg, place.number("lat_deg")};
    landmark.length_m = place.number("length_m");
    landmark.ground_height_m = kNaN;
    landmark.found = place.boolean("found");
    landmark.ambiguity = place.number_or_nan("ambiguity");
    place.finish();
    const std::string problem = landmark_problem(landmark, read.detectors.size());
    if (!problem.empty()) throw DataError(place.where() + ": " + problem);
    read.landmarks.push_back(landmark);
  }
  json.finish();
  const std::string problem = map_landmarks_problem(read);
  if (!problem.empty()) throw DataError(json.where() + ": " + problem);
  return read;
}

}  // namespace pilotage
