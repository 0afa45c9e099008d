#include "pilotage/flightlog/match_json.h"

#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include <nlohmann/json.hpp>

#include "pilotage/base/json_object.h"
#include "pilotage/base/text.h"

namespace pilotage {
namespace {

using Json = nlohmann::ordered_json;

Json place_json(const Fix& fix, GeodeticPoint Fix::*point, Eigen::Matrix2d Fix::*covariance) {
  const Eigen::Matrix2d& c = fix.*covariance;
  return {
      {"lon_deg", json_number((fix.*point).lon_deg)},
      {"lat_deg", json_number((fix.*point).lat_deg)},
      {"east_sigma_m", json_number(std::sqrt(c(0, 0)))},
      {"north_sigma_m", json_number(std::sqrt(c(1, 1)))},
      {"covariance_en_m2", {json_number(c(0, 0)), json_number(c(0, 1)), json_number(c(1, 0)), json_number(c(1, 1))}}};
}

Json fix_json(const std::optional<Fix>& fix, const std::optional<FixError>& error) {
  if (!fix) return nullptr;
  Json json = place_json(*fix, &Fix::position, &Fix::covariance_en_m2);
  json["center"] = place_json(*fix, &Fix::center, &Fix::center_covariance_en_m2);
  json["yaw_deg"] = json_number(fix->yaw_deg);
  json["pitch_deg"] = json_number(fix->pitch_deg);
  json["roll_deg"] = json_number(fix->roll_deg);
  json["yaw_sigma_deg"] = json_number(fix->yaw_sigma_deg);
  json["height_agl_m"] = json_number(fix->height_agl_m);
  json["height_sigma_m"] = json_number(fix->height_sigma_m);
  json["scale"] = json_number(fix->scale);
  json["tile_id"] = fix->tile_id ? Json(*fix->tile_id) : Json();
  if (!error) return json;
  json["error_m"] = json_number(error->error_m);
  json["error_east_m"] = json_number(error->east_m);
  json["error_north_m"] = json_number(error->north_m);
  json["nees"] = json_number(error->nees);
  return json;
}

Json stats_json(const MatchStats& stats) {
  return {{"level", stats.level},
          {"gsd_m", json_number(stats.gsd_m)},
          {"frame_features", stats.frame_features},
          {"map_features", stats.map_features},
          {"support", json_number(stats.support)},
          {"expected_features", stats.expected_features},
          {"vote_peak", json_number(stats.vote_peak)},
          {"vote_rival", json_number(stats.vote_rival)},
          {"inliers", stats.inliers},
          {"residual_m", json_number(stats.residual_m)},
          {"ncc", json_number(stats.ncc)},
          {"ncc_rival", json_number(stats.ncc_rival)},
          {"chip_pixels", stats.chip_pixels},
          {"agreement", json_number(stats.agreement)},
          {"confidence", json_number(stats.confidence)},
          {"search_half_width_m", json_number(stats.search_half_width_m)},
          {"landmarks_seen", stats.landmarks_seen},
          {"landmarks_expected", stats.landmarks_expected},
          {"landmarks_matched", stats.landmarks_matched}};
}

std::string fix_text(const Fix& fix) {
  const Eigen::Matrix2d& c = fix.covariance_en_m2;
  return "aircraft: lon " + format_fixed(fix.position.lon_deg, 7) + ", lat " + format_fixed(fix.position.lat_deg, 7) +
         ", sigma east " + format_fixed(std::sqrt(c(0, 0)), 2) + " m, north " + format_fixed(std::sqrt(c(1, 1)), 2) +
         " m\ncentre of the image: lon " + format_fixed(fix.center.lon_deg, 7) + ", lat " +
         format_fixed(fix.center.lat_deg, 7) + "\nyaw " + format_fixed(fix.yaw_deg, 2) + " deg, height " +
         format_fixed(fix.height_agl_m, 1) + " m above ground, " +
         (fix.tile_id ? "tile " + std::to_string(*fix.tile_id) : "no tile") + "\n";
}

}  // namespace

Json to_json(const FrameMatch& match, const std::vector<TakenField>& taken, bool timings) {
  Json json{{"frame", match.frame.file},
            {"status", frame_status_name(match)},
            {"reason", frame_status_text(match)},
            {"fix", fix_json(match.result.fix, match.error)},
            {"candidate", fix_json(match.result.candidate, match.candidate_error)},
            {"map_index", match.readable() ? Json(match.result.map_index) : Json()},
            {"map_statuses", match_status_names(match.result.map_statuses)},
            {"stats", stats_json(match.result.stats)}};
  if (timings) json["milliseconds"] = json_number(match.milliseconds);
  json["taken"] = to_json(taken);
  return json;
}

Json to_json(const std::vector<TakenField>& taken) {
  Json list = Json::array();
  for (const TakenField& one : taken) {
    list.push_back({{"file", one.file}, {"field", one.field}, {"value", json_number(one.value)}, {"tag", one.tag}});
  }
  return list;
}

std::string frame_match_text(const FrameMatch& match, bool timings) {
  const MatchStats& stats = match.result.stats;
  std::string text = frame_status_name(match) + ": " + frame_status_text(match) + "\n";
  if (match.has_fix()) text += fix_text(*match.result.fix);
  if (match.error) {
    text += std::string("error of ") + (match.frame.true_nadir ? "the aircraft's place" : "the centre of the image") +
            ": " + format_fixed(match.error->error_m, 2) + " m\n";
  }
  text += std::to_string(stats.inliers) + " inliers of " + std::to_string(stats.frame_features) +
          " features, against " + std::to_string(stats.map_features) + " of the map; vote " +
          format_fixed(stats.vote_peak, 1) + ", rival " + format_fixed(stats.vote_rival, 1) + ", confidence " +
          format_fixed(stats.confidence, 6) + "\n";
  if (stats.landmarks_seen > 0) {
    text += "landmarks seen: " + std::to_string(stats.landmarks_seen) +
            ", expected: " + std::to_string(stats.landmarks_expected) +
            ", matched: " + std::to_string(stats.landmarks_matched) + "\n";
  }
  if (timings) text += "time of matching: " + format_fixed(match.milliseconds, 1) + " ms\n";
  return text;
}

std::string taken_text(const std::vector<TakenField>& taken) {
  std::map<std::pair<std::string, std::string>, std::vector<double>> values;
  for (const TakenField& one : taken) values[{one.field, one.tag}].push_back(one.value);
  std::string text;
  for (const auto& [key, numbers] : values) {
    text += "from the picture: " + key.first +
            (numbers.size() == 1 ? " = " + format_number(std::round(numbers.front() * 1e7) / 1e7)
                                 : " of " + std::to_string(numbers.size()) + " frames") +
            " (" + key.second + ")\n";
  }
  return text;
}

}  // namespace pilotage
