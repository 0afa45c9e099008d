#include "pilotage/replay/replayed_frame.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <unordered_map>

#include <Eigen/LU>

#include "pilotage/base/csv.h"
#include "pilotage/base/error.h"
#include "pilotage/base/nan.h"
#include "pilotage/base/text.h"
#include "pilotage/geo/geodesic.h"
#include "pilotage/geo/local_frame.h"
#include "pilotage/geo/position_covariance.h"
#include "pilotage/match/position_measurement.h"
#include "pilotage/vehiclelog/pose_at.h"

namespace pilotage {
namespace {

constexpr double kBetweenFixesReach_s = 60;

bool is_place(GeodeticPoint point) {
  return std::abs(point.lat_deg) <= 90 && std::isfinite(point.lon_deg);
}

/// The prior's part is in the fix: match() lets it take part.
std::optional<InertialError> inertial_error_of(const Fix& fix, const FrameRecord& matched_with,
                                               GeodeticPoint inertial) {
  if (!is_place(inertial) || !is_place(matched_with.prior)) return std::nullopt;
  const PositionMeasurement alone = without_prior(
      fix, {matched_with.prior, matched_with.prior_covariance_en_m2, matched_with.height_agl_m, matched_with.attitude});
  // A table may be of other options: its fixes can be surer than the map's error that is to be taken off.
  if (!is_place(alone.position) || !alone.covariance_en_m2.allFinite() || !(alone.covariance_en_m2.determinant() > 0)) {
    return std::nullopt;
  }
  const Eigen::Vector3d error_m = -LocalFrame(inertial).enu_from_geodetic(alone.position);
  return InertialError{error_m.head<2>(), covariance_within_map(alone)};
}

Outcome outcome_of(const ReplayedFrame& frame, bool has_fix, double correct_within_m) {
  if (has_fix) return outcome_of_fix(frame.error_m, correct_within_m);
  return is_tried_status(frame.status) ? Outcome::kRefused : Outcome::kNotTried;
}

/// The best that is known: truth, a fix that is not false, the prior.
void set_place(ReplayedFrame& frame, const std::optional<GeodeticPoint>& truth,
               const std::optional<GeodeticPoint>& fix) {
  const auto set = [&](GeodeticPoint place, PlaceSource source) {
    frame.place = place;
    frame.place_from = source;
  };
  if (truth) return set(*truth, PlaceSource::kTruth);
  if (fix && frame.outcome != Outcome::kFalse) return set(*fix, PlaceSource::kFix);
  if (frame.prior && is_place(*frame.prior)) return set(*frame.prior, PlaceSource::kPrior);
}

void set_navigated(ReplayedFrame& frame, const std::optional<GeodeticPoint>& truth, GeodeticPoint position,
                   const Eigen::Matrix2d& covariance_m2) {
  if (!truth || !is_place(position) || !covariance_m2.allFinite()) return;
  frame.navigated_sigma_m = largest_sigma_m(covariance_m2);
  frame.navigated_error_m = geodesic_between(*truth, position).length_m;
}

}  // namespace

bool is_tried_status(const std::string& status) {
  static const std::set<std::string> kNothingToMatch{"unreadable",    "bad_frame",     "bad_prior",
                                                     "bad_camera",    "bad_options",   "out_of_time",
                                                     "too_uncertain", "out_of_memory", "map_unreadable"};
  return !kNothingToMatch.contains(status);
}

std::vector<ReplayedFrame> replayed_frames(std::span<const FrameMatch> matches, std::span<const FlightFrame> rows,
                                           double correct_within_m) {
  std::vector<ReplayedFrame> frames;
  for (std::size_t i = 0; i < matches.size(); ++i) {
    const FrameMatch& match = matches[i];
    const FrameRecord& row = rows[i].frame;
    ReplayedFrame frame;
    frame.file = row.file;
    frame.time_s = row.time_s;
    frame.status = frame_status_name(match);
    frame.height_agl_m = row.height_agl_m;
    frame.yaw_deg = row.attitude.yaw_deg;
    if (is_place(row.prior)) frame.prior = row.prior;
    frame.prior_sigma_m = largest_sigma_m(match.frame.prior_covariance_en_m2);
    if (match.error && match.has_fix()) {
      frame.error_m = match.error->error_m;
      frame.nees = match.error->nees;
    }
    frame.map_count = std::max<std::size_t>(1, match.result.map_statuses.size());
    frame.outcome = outcome_of(frame, match.has_fix(), correct_within_m);
    if (match.has_fix()) frame.inertial_error = inertial_error_of(*match.result.fix, match.frame, row.prior);
    std::optional<GeodeticPoint> fix;
    if (match.has_fix()) fix = match.result.fix->position;
    set_place(frame, row.truth(), fix);
    set_navigated(frame, row.true_nadir, fix.value_or(match.frame.prior),
                  fix ? match.result.fix->covariance_en_m2 : match.frame.prior_covariance_en_m2);
    frames.push_back(std::move(frame));
  }
  return frames;
}

namespace {

/// Cells of fixes.csv by the names of their columns.
class FixRow {
 public:
  FixRow(const CsvTable& table, const std::vector<std::string>& cells) : table_(table), cells_(cells) {}

  /// "" where the table has no such column.
  std::string text(const std::string& column) const {
    const auto& names = table_.columns();
    const auto found = std::find(names.begin(), names.end(), column);
    return found == names.end() ? "" : cells_[static_cast<std::size_t>(found - names.begin())];
  }
  double number(const std::string& column, double low, double high) const {
    const std::string cell = text(column);
    if (cell.empty()) return kNaN;
    const auto value = parse_number(cell);
    if (value && *value >= low && *value <= high) return *value;
    throw DataError(table_.where() + column + " = \"" + cell.substr(0, 40) + "\" is not a number in [" +
                    format_number(low) + ", " + format_number(high) + "]");
  }

 private:
  const CsvTable& table_;
  const std::vector<std::string>& cells_;
};

struct ReadFix {
  ReplayedFrame frame;
  std::optional<GeodeticPoint> fix;
};

ReadFix read_fix_row(const CsvTable& table, const FixRow& row, const FrameRecord* record, double correct_within_m) {
  ReadFix read;
  ReplayedFrame& frame = read.frame;
  frame.file = row.text("file");
  frame.time_s = row.number("time_s", -1e12, 1e12);
  frame.status = row.text("status");
  if (frame.file.empty() || frame.status.empty()) throw DataError(table.where() + "file or status is empty");
  frame.error_m = row.number("error_m", 0, 1e8);
  frame.nees = row.number("nees", 0, 1e300);
  frame.height_agl_m = row.number("height_agl_m", -1000, 100000);
  frame.yaw_deg = row.number("yaw_deg", -360, 360);
  const double lon_deg = row.number("lon_deg", -180, 360);
  const double lat_deg = row.number("lat_deg", -90, 90);
  const bool has_fix = frame.status == "fix";
  frame.prior_sigma_m = row.number("search_half_width_m", 0, 1e7) / MatchOptions{}.search_sigmas;
  if (has_fix && (std::isnan(lon_deg) || std::isnan(lat_deg))) {
    throw DataError(table.where() + "status is \"fix\", but lon_deg or lat_deg is empty");
  }
  const std::string statuses = row.text("map_statuses");
  frame.map_count = 1 + static_cast<std::size_t>(std::count(statuses.begin(), statuses.end(), ';'));
  frame.outcome = outcome_of(frame, has_fix, correct_within_m);
  if (has_fix) read.fix = GeodeticPoint{wrap_lon_deg(lon_deg), lat_deg};
  if (record != nullptr) {
    if (is_place(record->prior)) frame.prior = record->prior;
    if (std::isnan(frame.height_agl_m)) frame.height_agl_m = record->height_agl_m;
    if (std::isnan(frame.yaw_deg)) frame.yaw_deg = record->attitude.yaw_deg;
  }
  const std::optional<GeodeticPoint> truth = record != nullptr ? record->true_nadir : std::nullopt;
  if (!read.fix && frame.prior) set_navigated(frame, truth, *frame.prior, record->prior_covariance_en_m2);
  if (read.fix) {
    const double east_m = row.number("east_sigma_m", 0, 1e6);
    const double north_m = row.number("north_sigma_m", 0, 1e6);
    const double shared_m2 = row.number("covariance_en_m2", -1e12, 1e12);
    Fix fix;
    fix.position = *read.fix;
    fix.covariance_en_m2 << east_m * east_m, shared_m2, shared_m2, north_m * north_m;
    const double map_sigma_m = row.number("map_sigma_m", 0, 100);
    fix.map_sigma_m = std::isnan(map_sigma_m) ? kUnknownMapSigma_m : map_sigma_m;  // older tables do not say
    fix.map_error_is_shared = frame.map_count == 1;
    set_navigated(frame, truth, fix.position, fix.covariance_en_m2);
    if (frame.prior && fix.covariance_en_m2.allFinite() && fix.covariance_en_m2.determinant() > 0) {
      frame.inertial_error = inertial_error_of(fix, *record, *frame.prior);
    }
  }
  return read;
}

/// Frames without a place of their own lie between the fixes before and behind them.
void place_between_fixes(std::vector<ReplayedFrame>& frames) {
  std::vector<LoggedPosition> fixes;
  for (const ReplayedFrame& frame : frames) {
    const bool known = frame.place_from == PlaceSource::kTruth || frame.place_from == PlaceSource::kFix;
    if (known && std::isfinite(frame.time_s)) fixes.push_back({frame.time_s, frame.place});
  }
  std::stable_sort(fixes.begin(), fixes.end(), [](const auto& a, const auto& b) { return a.time_s < b.time_s; });
  for (ReplayedFrame& frame : frames) {
    if (frame.place_from != PlaceSource::kNone || !std::isfinite(frame.time_s)) continue;
    const auto between = position_at(fixes, frame.time_s, kBetweenFixesReach_s);
    if (!between) continue;
    frame.place = between->point;
    frame.place_from = PlaceSource::kBetweenFixes;
  }
}

}  // namespace

std::vector<ReplayedFrame> frames_of_fix_table(const std::string& name, std::string_view text,
                                               std::span<const FrameRecord> rows, double correct_within_m) {
  CsvTable table(name, text, "a table of fixes");
  for (const char* needed : {"file", "time_s", "status"}) {
    const auto& names = table.columns();
    if (std::find(names.begin(), names.end(), needed) != names.end()) continue;
    throw DataError(table.where() + "column \"" + needed + "\" is missing; the columns are " + join(names, ", "));
  }
  std::unordered_map<std::string, const FrameRecord*> records;
  for (const FrameRecord& row : rows) records.emplace(row.file, &row);
  std::vector<ReplayedFrame> frames;
  while (const auto* cells = table.next()) {
    const FixRow row(table, *cells);
    const auto record = records.find(row.text("file"));
    const FrameRecord* of_frame = record == records.end() ? nullptr : record->second;
    ReadFix read = read_fix_row(table, row, of_frame, correct_within_m);
    const auto truth = of_frame != nullptr ? of_frame->truth() : std::nullopt;
    set_place(read.frame, truth, read.fix);
    frames.push_back(std::move(read.frame));
  }
  if (frames.empty()) throw DataError(name + ": has no frame, only a line of names");
  place_between_fixes(frames);
  return frames;
}

}  // namespace pilotage
