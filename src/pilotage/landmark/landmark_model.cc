#include "pilotage/landmark/landmark_model.h"

#include <set>

#include <nlohmann/json.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/json_object.h"
#include "pilotage/base/utf8.h"
#include "pilotage/mission/landmark_file.h"

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

Json learnt_to_json(const LearntDetector& learnt) {
  Json json = detector_to_json(learnt.detector);
  json["quality"] = {{"blocks", learnt.quality.blocks},
                     {"average_precision", json_number(learnt.quality.average_precision)},
                     {"recall", share_counts(learnt.quality.recall)},
                     {"precision", share_counts(learnt.quality.precision)}};
  json["learnt_lon_lat_deg"] = Json::array();
  for (const GeodeticPoint& place : learnt.places) {
    json["learnt_lon_lat_deg"].push_back({place.lon_deg, place.lat_deg});
  }
  return json;
}

LearntDetector learnt_from_json(JsonObject& json) {
  LearntDetector learnt;
  learnt.detector = detector_from_json(json);
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
  json.finish();
  return learnt;
}

}  // namespace

Json landmark_model_to_json(const LandmarkModel& model) {
  Json detectors = Json::array();
  for (const LearntDetector& learnt : model.detectors) detectors.push_back(learnt_to_json(learnt));
  return digested_json(kFormat, kVersion, {{"detectors", detectors}});
}

LandmarkModel read_landmark_model(const std::filesystem::path& path) {
  const Json content = read_digested_json(path, kFormat, kVersion, "landmark-train");
  const std::string file = name_as_utf8(path.string());
  JsonObject json(content, file);
  LandmarkModel model;
  std::set<std::string> classes;
  for (JsonObject& detector : json.objects("detectors")) {
    model.detectors.push_back(learnt_from_json(detector));
    const std::string& class_name = model.detectors.back().detector.class_name;
    if (!classes.insert(class_name).second) {
      throw DataError(file + ": has two detectors of the class " + class_name);
    }
  }
  json.finish();
  if (model.detectors.empty()) throw DataError(file + ": holds no detector");
  return model;
}

}  // namespace pilotage
