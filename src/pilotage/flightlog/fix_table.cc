#include "pilotage/flightlog/fix_table.h"

#include <cmath>
#include <utility>

#include "pilotage/base/csv.h"
#include "pilotage/base/nan.h"
#include "pilotage/base/text.h"

namespace pilotage {
namespace {

class ColumnList {
 public:
  void text(std::string name, std::function<std::string(const FrameMatch&)> get) {
    columns_.push_back(
        {std::move(name), [get = std::move(get)](const FrameMatch& match) { return csv_cell(get(match)); }});
  }
  void number(std::string name, std::function<double(const FrameMatch&)> get) {
    columns_.push_back(
        {std::move(name), [get = std::move(get)](const FrameMatch& match) { return csv_cell(get(match)); }});
  }
  /// Empty unless there is a fix.
  template <class Get>
  void of_fix(std::string name, Get get) {
    columns_.push_back({std::move(name), [get](const FrameMatch& match) {
                          return match.has_fix() ? csv_cell(static_cast<double>(get(*match.result.fix))) : "";
                        }});
  }
  /// Empty when there was nothing to match.
  template <class Get>
  void of_stats(std::string name, Get get) {
    columns_.push_back({std::move(name), [get](const FrameMatch& match) {
                          return match.readable() ? csv_cell(static_cast<double>(get(match.result.stats))) : "";
                        }});
  }
  void of_error(std::string name, std::optional<FixError> FrameMatch::*error, double FixError::*member) {
    columns_.push_back({std::move(name), [error, member](const FrameMatch& match) {
                          return match.*error ? csv_cell(*(match.*error).*member) : "";
                        }});
  }
  std::vector<FixColumn> take() { return std::move(columns_); }

 private:
  std::vector<FixColumn> columns_;
};

void add_place(ColumnList& list, const std::string& prefix, GeodeticPoint Fix::*point,
               Eigen::Matrix2d Fix::*covariance) {
  list.of_fix(prefix + "lon_deg", [=](const Fix& fix) { return (fix.*point).lon_deg; });
  list.of_fix(prefix + "lat_deg", [=](const Fix& fix) { return (fix.*point).lat_deg; });
  list.of_fix(prefix + "east_sigma_m", [=](const Fix& fix) { return std::sqrt((fix.*covariance)(0, 0)); });
  list.of_fix(prefix + "north_sigma_m", [=](const Fix& fix) { return std::sqrt((fix.*covariance)(1, 1)); });
  list.of_fix(prefix + "covariance_en_m2", [=](const Fix& fix) { return (fix.*covariance)(0, 1); });
}

}  // namespace

std::vector<FixColumn> fix_columns(bool timings) {
  ColumnList list;
  list.text("file", [](const FrameMatch& match) { return match.frame.file; });
  list.number("time_s", [](const FrameMatch& match) { return match.frame.time_s; });
  list.text("status", frame_status_name);
  list.text("reason", [](const FrameMatch& match) { return match.has_fix() ? "" : frame_status_text(match); });
  add_place(list, "", &Fix::position, &Fix::covariance_en_m2);
  add_place(list, "center_", &Fix::center, &Fix::center_covariance_en_m2);
  list.of_fix("yaw_deg", [](const Fix& fix) { return fix.yaw_deg; });
  list.of_fix("yaw_sigma_deg", [](const Fix& fix) { return fix.yaw_sigma_deg; });
  list.of_fix("pitch_deg", [](const Fix& fix) { return fix.pitch_deg; });
  list.of_fix("roll_deg", [](const Fix& fix) { return fix.roll_deg; });
  list.of_fix("height_agl_m", [](const Fix& fix) { return fix.height_agl_m; });
  list.of_fix("height_sigma_m", [](const Fix& fix) { return fix.height_sigma_m; });
  list.of_fix("scale", [](const Fix& fix) { return fix.scale; });
  list.of_fix("tile_id", [](const Fix& fix) { return fix.tile_id ? static_cast<double>(*fix.tile_id) : kNaN; });
  list.of_fix("map_sigma_m", [](const Fix& fix) { return fix.map_sigma_m; });
  list.text("map_index",
            [](const FrameMatch& match) { return match.readable() ? std::to_string(match.result.map_index) : ""; });
  list.text("map_statuses", [](const FrameMatch& match) {
    return match.readable() ? join(match_status_names(match.result.map_statuses), ";") : "";
  });
  list.of_stats("level", [](const MatchStats& stats) { return stats.level; });
  list.of_stats("gsd_m", [](const MatchStats& stats) { return stats.gsd_m; });
  list.of_stats("frame_features", [](const MatchStats& stats) { return stats.frame_features; });
  list.of_stats("map_features", [](const MatchStats& stats) { return stats.map_features; });
  list.of_stats("support", [](const MatchStats& stats) { return stats.support; });
  list.of_stats("expected_features", [](const MatchStats& stats) { return stats.expected_features; });
  list.of_stats("vote_peak", [](const MatchStats& stats) { return stats.vote_peak; });
  list.of_stats("vote_rival", [](const MatchStats& stats) { return stats.vote_rival; });
  list.of_stats("inliers", [](const MatchStats& stats) { return stats.inliers; });
  list.of_stats("residual_m", [](const MatchStats& stats) { return stats.residual_m; });
  list.of_stats("ncc", [](const MatchStats& stats) { return stats.ncc; });
  list.of_stats("ncc_rival", [](const MatchStats& stats) { return stats.ncc_rival; });
  list.of_stats("chip_pixels", [](const MatchStats& stats) { return stats.chip_pixels; });
  list.of_stats("agreement", [](const MatchStats& stats) { return stats.agreement; });
  list.of_stats("confidence", [](const MatchStats& stats) { return stats.confidence; });
  list.of_stats("search_half_width_m", [](const MatchStats& stats) { return stats.search_half_width_m; });
  list.of_stats("landmarks_seen", [](const MatchStats& stats) { return stats.landmarks_seen; });
  list.of_stats("landmarks_expected", [](const MatchStats& stats) { return stats.landmarks_expected; });
  list.of_stats("landmarks_matched", [](const MatchStats& stats) { return stats.landmarks_matched; });
  list.text("confirmed", [](const FrameMatch& match) { return match.has_fix() ? (match.confirmed ? "1" : "0") : ""; });
  list.of_error("error_m", &FrameMatch::error, &FixError::error_m);
  list.of_error("error_east_m", &FrameMatch::error, &FixError::east_m);
  list.of_error("error_north_m", &FrameMatch::error, &FixError::north_m);
  list.of_error("nees", &FrameMatch::error, &FixError::nees);
  list.of_error("center_error_m", &FrameMatch::center_error, &FixError::error_m);
  list.of_error("center_nees", &FrameMatch::center_error, &FixError::nees);
  list.of_error("candidate_error_m", &FrameMatch::candidate_error, &FixError::error_m);
  list.of_error("candidate_center_error_m", &FrameMatch::candidate_center_error, &FixError::error_m);
  if (timings) list.number("milliseconds", [](const FrameMatch& match) { return match.milliseconds; });
  return list.take();
}

std::string fix_table_to_csv(std::span<const FrameMatch> matches, bool timings) {
  const std::vector<FixColumn> columns = fix_columns(timings);
  std::string text;
  for (const FixColumn& column : columns) text += (text.empty() ? "" : ",") + column.name;
  text += '\n';
  for (const FrameMatch& match : matches) {
    bool first = true;
    for (const FixColumn& column : columns) {
      if (!first) text += ',';
      first = false;
      text += column.write(match);
    }
    text += '\n';
  }
  return text;
}

}  // namespace pilotage
