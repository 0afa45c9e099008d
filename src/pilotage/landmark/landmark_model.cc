#include "pilotage/landmark/landmark_model.h"

#include <algorithm>
#include <cmath>
#include <set>

#include <nlohmann/json.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/file_digest.h"
#include "pilotage/base/json_object.h"
#include "pilotage/base/options_json.h"
#include "pilotage/base/read_file.h"
#include "pilotage/base/text.h"
#include "pilotage/base/utf8.h"

namespace pilotage {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kFormat = "pilotage landmark model";
constexpr int kVersion = 1;

Json share_counts(const Share& share) {
  return {{"count", share.count}, {"of", share.of}};
}

Share share_of(JsonObject json) {
  Share share;
  share.count = json.integer("count", 0);
  share.of = json.integer("of", share.count);
  json.finish();
  return share;
}

Json detector_to_json(const LearntDetector& learnt_detector) {
  const auto& [detector, places, quality] = learnt_detector;
  Json learnt = Json::array();
  for (const GeodeticPoint& place : places) learnt.push_back({place.lon_deg, place.lat_deg});
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
          {"quality",
           {{"blocks", quality.blocks},
            {"average_precision", json_number(quality.average_precision)},
            {"recall", share_counts(quality.recall)},
            {"precision", share_counts(quality.precision)}}},
          {"learnt_lon_lat_deg", learnt},
          {"filters", detector.filters}};
}

LearntDetector detector_from_json(JsonObject& json) {
  LearntDetector learnt;
  LandmarkDetector& detector = learnt.detector;
  detector.class_name = json.text("class");
  detector.gsd_m = json.positive_number("gsd_m");
  detector.window.cell_px = json.small_integer("cell_px", 2, 64);
  detector.window.side_px = json.small_integer("window_px", detector.window.cell_px, 1024);
  if (detector.window.side_px % detector.window.cell_px != 0) json.fail("window_px", "a multiple of cell_px");
  if (detector.window.side_px / detector.window.cell_px % 2 == 0) json.fail("window_px", "an odd multiple of cell_px");
  detector.window.levels = json.small_integer("levels", 1, 64);
  detector.context = json.positive_number("context");
  const std::vector<double> offset = json.numbers("offset", 2);
  detector.offset = {offset[0], offset[1]};
  detector.period_deg = json.number("period_deg");
  detector.threshold = json.number("threshold");
  detector.shortest_m = json.positive_number("shortest_m");
  detector.longest_m = json.positive_number("longest_m");
  constexpr double kMostWindow_px = 8192;
  if (!(detector.gsd_m >= 1e-3 && detector.gsd_m <= 1e3)) json.fail("gsd_m", "0.001 to 1000");
  if (!(detector.context >= 1 && detector.context <= 10)) json.fail("context", "1 to 10");
  if (!(detector.period_deg >= 0 && detector.period_deg <= 360)) json.fail("period_deg", "0 to 360");
  if (!(offset[0] >= -1 && offset[0] <= 1 && offset[1] >= -1 && offset[1] <= 1)) json.fail("offset", "-1 to 1");
  if (!(detector.longest_m >= detector.shortest_m &&
        detector.context * detector.longest_m / detector.gsd_m <= kMostWindow_px)) {
    json.fail("longest_m",
              "from shortest_m to what " + format_number(kMostWindow_px) + " pixels hold with its context");
  }
  JsonObject quality = json.object("quality");
  learnt.quality.blocks = quality.small_integer("blocks", 0);
  learnt.quality.average_precision = quality.number_or_nan("average_precision");
  learnt.quality.recall = share_of(quality.object("recall"));
  learnt.quality.precision = share_of(quality.object("precision"));
  quality.finish();
  for (const Json& place : json.list("learnt_lon_lat_deg")) {
    if (!place.is_array() || place.size() != 2 || !place[0].is_number() || !place[1].is_number()) {
      json.fail("learnt_lon_lat_deg", "pairs of longitude and latitude");
    }
    learnt.places.push_back({place[0].get<double>(), place[1].get<double>()});
  }
  for (const Json& filter : json.list("filters")) {
    if (!filter.is_array() || !std::all_of(filter.begin(), filter.end(), [](const Json& w) { return w.is_number(); })) {
      json.fail("filters", "lists of numbers");
    }
    detector.filters.push_back(filter.get<std::vector<float>>());
    if (detector.filters.back().size() != detector.window.filter_size()) {
      json.fail("filters", "lists of " + std::to_string(detector.window.filter_size()) + " numbers");
    }
  }
  if (detector.filters.empty()) json.fail("filters", "one list at least");
  json.finish();
  return learnt;
}

}  // namespace

Json landmark_model_to_json(const LandmarkModel& model) {
  Json detectors = Json::array();
  for (const LearntDetector& learnt : model.detectors) detectors.push_back(detector_to_json(learnt));
  Json json = {{"format", kFormat}, {"version", kVersion}, {"detectors", detectors}};
  json["digest"] = bytes_digest(json_text(json, 0));
  return json;
}

LandmarkModel read_landmark_model(const std::filesystem::path& path) {
  const std::string file = name_as_utf8(path.string());
  Json content = parse_json(file, read_file(path));
  JsonObject json(content, file);
  if (!json.has("format") || json.text("format") != kFormat) {
    throw DataError(file + ": is no landmark model; `pilotage landmark-train` writes one");
  }
  if (json.integer("version") != kVersion) {
    throw DataError(file + ": is a landmark model of version " + std::to_string(json.integer("version")) +
                    "; this program reads version " + std::to_string(kVersion));
  }
  const std::string digest = json.text("digest");
  LandmarkModel model;
  for (JsonObject& detector : json.objects("detectors")) model.detectors.push_back(detector_from_json(detector));
  json.finish();
  std::set<std::string> classes;
  for (const LearntDetector& learnt : model.detectors) {
    if (!classes.insert(learnt.detector.class_name).second) {
      throw DataError(file + ": has two detectors of the class " + learnt.detector.class_name);
    }
  }
  Json signed_part = content;
  signed_part.erase("digest");
  if (bytes_digest(json_text(signed_part, 0)) != digest) {
    throw IntegrityError(file + ": was changed after it was written: its content has another digest");
  }
  if (model.detectors.empty()) throw DataError(file + ": holds no detector");
  return model;
}

}  // namespace pilotage
