#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "pilotage/base/error.h"
#include "pilotage/base/nan.h"
#include "pilotage/base/text.h"
#include "pilotage/geo/local_frame.h"
#include "pilotage/vehiclelog/log_builder.h"
#include "pilotage/vehiclelog/log_readers.h"

namespace pilotage {
namespace {

constexpr std::string_view kFirstColumn = "VehicleName\t";

std::string_view take_recording_line(std::string_view& rest) {
  const std::size_t end = std::min(rest.find('\n'), rest.size());
  std::string_view line = rest.substr(0, end);
  rest.remove_prefix(std::min(end + 1, rest.size()));
  if (line.ends_with('\r')) line.remove_suffix(1);
  return line;
}

std::vector<std::string_view> split_at_tabs(std::string_view line) {
  std::vector<std::string_view> cells;
  for (;;) {
    const std::size_t tab = std::min(line.find('\t'), line.size());
    cells.push_back(line.substr(0, tab));
    if (tab == line.size()) return cells;
    line.remove_prefix(tab + 1);
  }
}

/// A row, with the columns of the first line.
class RecordingRow {
 public:
  RecordingRow(const std::vector<std::string_view>& names, std::vector<std::string_view> cells)
      : names_(names), cells_(std::move(cells)) {}

  std::string_view text(std::string_view name) const {
    const auto found = std::find(names_.begin(), names_.end(), name);
    const auto index = static_cast<std::size_t>(found - names_.begin());
    return found == names_.end() || index >= cells_.size() ? std::string_view() : cells_[index];
  }
  double number(std::string_view name) const { return parse_number(text(name)).value_or(kNaN); }

 private:
  const std::vector<std::string_view>& names_;
  std::vector<std::string_view> cells_;
};

/// Pictures of one instant stand in one cell, with ";" between them: the first is taken.
std::string picture_of(const RecordingRow& row) {
  const std::string_view files = row.text("ImageFile");
  const std::string file(files.substr(0, files.find(';')));
  return file.empty() || file.find('/') != std::string::npos ? file : "images/" + file;
}

void take_recording_row(const RecordingRow& row, const LocalFrame& frame, double origin_amsl_m, LogBuilder& builder) {
  static constexpr double kFurthest_m = 1e6;
  const double time_s = row.number("TimeStamp") * 1e-3;
  if (!builder.accept(time_s)) return;
  const double north_m = row.number("POS_X");
  const double east_m = row.number("POS_Y");
  const double down_m = row.number("POS_Z");
  if (!(std::abs(north_m) < kFurthest_m && std::abs(east_m) < kFurthest_m)) {
    ++builder.losses().bad_values;
    return;
  }
  const GeodeticPoint point = frame.geodetic_from_enu({east_m, north_m, 0});
  const double amsl_m = origin_amsl_m - down_m;
  builder.add_position(&VehicleLog::truth, time_s, point.lat_deg, point.lon_deg, amsl_m);
  const auto attitude =
      attitude_of_quaternion(row.number("Q_W"), row.number("Q_X"), row.number("Q_Y"), row.number("Q_Z"));
  if (attitude) {
    builder.add_attitude(&VehicleLog::truth, time_s, *attitude);
  } else {
    ++builder.losses().bad_values;
  }
  LoggedCapture capture;
  capture.time_s = time_s;
  capture.point = point;
  capture.amsl_m = amsl_m;
  capture.attitude = attitude;
  capture.file = picture_of(row);
  if (!capture.file.empty()) builder.add_capture(std::move(capture));
}

}  // namespace

bool is_airsim_recording(std::string_view text) {
  return text.starts_with(kFirstColumn);
}

VehicleLog parse_airsim_recording(const std::string& name, std::string_view text, const LogOrigin& origin) {
  std::string_view rest = text;
  const std::vector<std::string_view> names = split_at_tabs(take_recording_line(rest));
  for (const std::string_view needed : {"VehicleName", "TimeStamp", "POS_X", "POS_Y", "POS_Z", "Q_W", "ImageFile"}) {
    if (std::find(names.begin(), names.end(), needed) == names.end()) {
      throw DataError(name + ": line 1: column \"" + std::string(needed) + "\" of an AirSim recording is missing");
    }
  }
  LogBuilder builder(LogFormat::kAirSim);
  const LocalFrame frame(origin.point);
  std::string vehicle;
  while (!rest.empty()) {
    const std::string_view line = take_recording_line(rest);
    if (line.empty()) continue;
    const RecordingRow row(names, split_at_tabs(line));
    const std::string_view of(row.text("VehicleName"));
    if (vehicle.empty()) vehicle = of;
    if (of != vehicle) {
      ++builder.losses().other_sources;
      continue;
    }
    take_recording_row(row, frame, origin.amsl_m, builder);
  }
  return builder.finish();
}

}  // namespace pilotage
