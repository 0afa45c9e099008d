#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "pilotage/base/error.h"
#include "pilotage/base/nan.h"
#include "pilotage/base/text.h"
#include "pilotage/base/utf8.h"
#include "pilotage/geo/local_frame.h"
#include "pilotage/vehiclelog/log_builder.h"
#include "pilotage/vehiclelog/log_readers.h"

namespace pilotage {
namespace {

/// What a column is called: today, and in the first versions.
struct ColumnNames {
  std::string_view name;
  std::string_view first_name;
};
constexpr ColumnNames kTime{"TimeStamp", "Timestamp"};
constexpr ColumnNames kNorth{"POS_X", "Position(x)"};
constexpr ColumnNames kEast{"POS_Y", "Position(y)"};
constexpr ColumnNames kDown{"POS_Z", "Position(z)"};
constexpr ColumnNames kTurnW{"Q_W", "Orientation(w)"};
constexpr ColumnNames kTurnX{"Q_X", "Orientation(x)"};
constexpr ColumnNames kTurnY{"Q_Y", "Orientation(y)"};
constexpr ColumnNames kTurnZ{"Q_Z", "Orientation(z)"};
constexpr ColumnNames kPicture{"ImageFile", "ImageName"};
constexpr std::string_view kVehicle = "VehicleName";  // the first versions have one vehicle

std::string_view take_recording_line(std::string_view& rest) {
  const std::size_t end = std::min(rest.find('\n'), rest.size());
  std::string_view line = rest.substr(0, end);
  rest.remove_prefix(std::min(end + 1, rest.size()));
  if (line.ends_with('\r')) line.remove_suffix(1);
  return line;
}

/// Of a row, and pictures in a cell: recordings have some ten.
constexpr std::size_t kMostCells = 1000;

/// The first cells, at most `most`.
std::vector<std::string_view> split_at(char mark, std::string_view line, std::size_t most = kMostCells) {
  std::vector<std::string_view> cells;
  while (cells.size() < most) {
    const std::size_t end = std::min(line.find(mark), line.size());
    cells.push_back(line.substr(0, end));
    if (end == line.size()) break;
    line.remove_prefix(end + 1);
  }
  return cells;
}

/// The first line: where each column stands in a row.
class RecordingColumns {
 public:
  /// Throws DataError, beginning with `name`, when one that is needed is missing, or there are too many.
  RecordingColumns(const std::string& name, std::string_view line) : names_(split_at('\t', line, kMostCells + 1)) {
    if (names_.size() > kMostCells) {
      throw DataError(name + ": line 1: an AirSim recording of more than " + std::to_string(kMostCells) + " columns");
    }
    for (std::size_t i = 0; i < names_.size(); ++i) indices_.try_emplace(names_[i], i);
    for (const ColumnNames& needed : {kTime, kNorth, kEast, kDown, kTurnW, kTurnX, kTurnY, kTurnZ, kPicture}) {
      if (index(needed)) continue;
      throw DataError(name + ": line 1: column \"" + std::string(needed.name) + "\" (or \"" +
                      std::string(needed.first_name) + "\") of an AirSim recording is missing");
    }
  }

  std::size_t count() const { return names_.size(); }
  std::optional<std::size_t> index(const ColumnNames& column) const {
    for (const std::string_view name : {column.name, column.first_name}) {
      if (const auto found = indices_.find(name); found != indices_.end()) return found->second;
    }
    return std::nullopt;
  }

 private:
  std::vector<std::string_view> names_;
  std::map<std::string_view, std::size_t> indices_;
};

/// A row; what stands behind the columns of the first line has no name.
class RecordingRow {
 public:
  RecordingRow(const RecordingColumns& columns, std::string_view line)
      : columns_(columns), cells_(split_at('\t', line, columns.count())) {}

  std::string_view text(const ColumnNames& column) const {
    const auto index = columns_.index(column);
    return index && *index < cells_.size() ? cells_[*index] : std::string_view();
  }
  double number(const ColumnNames& column) const { return parse_number(text(column)).value_or(kNaN); }

 private:
  const RecordingColumns& columns_;
  std::vector<std::string_view> cells_;
};

/// What the name of a picture says: img_[vehicle_]camera_type_time.
struct RecordedPicture {
  std::string file;
  std::string camera;
  std::optional<int> type;  ///< Nothing where the name is another.

  bool is_scene() const { return type == 0; }
  bool looks_down() const { return camera == "3" || camera == "bottom_center"; }
};

RecordedPicture recorded_picture(std::string_view file) {
  RecordedPicture picture{std::string(file), "", {}};
  std::string_view stem = file.substr(file.find_last_of("/\\") + 1);
  stem = stem.substr(0, stem.rfind('.'));
  const std::vector<std::string_view> parts = split_at('_', stem);
  if (parts.size() < 4 || parts.front() != "img") return picture;
  const auto type = parse_number(parts[parts.size() - 2]);
  if (!type || *type < 0 || *type > 99 || *type != std::floor(*type)) return picture;
  picture.type = static_cast<int>(*type);
  // Cameras have numbers or names such as bottom_center; a vehicle's name, which may have "_" as well, stands before.
  const std::string_view last = parts[parts.size() - 3];
  picture.camera = last == "center" || last == "right" || last == "left"
                       ? std::string(parts[parts.size() - 4]) + "_" + std::string(last)
                       : std::string(last);
  return picture;
}

/// Pictures of one instant stand in one cell, with ";" between them.
std::vector<RecordedPicture> pictures_of(const RecordingRow& row) {
  std::vector<RecordedPicture> pictures;
  for (const std::string_view file : split_at(';', row.text(kPicture))) {
    if (!file.empty()) pictures.push_back(recorded_picture(file));
  }
  return pictures;
}

/// The one that shows the scene, of the camera that looks down where there are several; the first where names say
/// nothing. "" when only others are there: depth, segmentation …
std::string picture_of(const RecordingRow& row, LogBuilder& builder) {
  const std::vector<RecordedPicture> pictures = pictures_of(row);
  const RecordedPicture* best = nullptr;
  for (const RecordedPicture& picture : pictures) {
    const bool counts = picture.is_scene() || !picture.type;
    if (!counts) continue;
    if (best == nullptr || (picture.looks_down() && !best->looks_down())) best = &picture;
  }
  for (const RecordedPicture& picture : pictures) {
    if (&picture == best) continue;
    builder.leave_out_source(picture.is_scene() || !picture.type ? "another picture, of camera " + picture.camera
                                                                 : "image type " + std::to_string(*picture.type));
  }
  if (best == nullptr) return "";
  return best->file.find('/') != std::string::npos ? best->file : "images/" + best->file;
}

void take_recording_row(const RecordingRow& row, const LocalFrame& frame, double origin_amsl_m, LogBuilder& builder) {
  static constexpr double kFurthest_m = 1e6;
  const double time_s = row.number(kTime) * 1e-3;
  if (!builder.accept(time_s)) return;
  const double north_m = row.number(kNorth);
  const double east_m = row.number(kEast);
  const double down_m = row.number(kDown);
  if (!(std::abs(north_m) < kFurthest_m && std::abs(east_m) < kFurthest_m)) {
    ++builder.losses().bad_values;
    return;
  }
  const GeodeticPoint point = frame.geodetic_from_enu({east_m, north_m, 0});
  const double amsl_m = origin_amsl_m - down_m;
  builder.add_position(&VehicleLog::truth, time_s, point.lat_deg, point.lon_deg, amsl_m);
  const auto attitude =
      attitude_of_quaternion(row.number(kTurnW), row.number(kTurnX), row.number(kTurnY), row.number(kTurnZ));
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
  capture.file = picture_of(row, builder);
  if (!capture.file.empty()) builder.add_capture(std::move(capture));
}

}  // namespace

bool is_airsim_recording(std::string_view text) {
  text = without_byte_order_mark(text);
  const std::vector<std::string_view> names = split_at('\t', take_recording_line(text));
  const auto has = [&](const ColumnNames& column) {
    return std::any_of(names.begin(), names.end(),
                       [&](std::string_view name) { return name == column.name || name == column.first_name; });
  };
  return names.size() > 1 && has(kTime) && has(kPicture);
}

VehicleLog parse_airsim_recording(const std::string& name, std::string_view text, const LogOrigin& origin) {
  std::string_view rest = without_byte_order_mark(text);
  const RecordingColumns columns(name, take_recording_line(rest));
  LogBuilder builder(LogFormat::kAirSim);
  const LocalFrame frame(origin.point);
  std::string vehicle;
  while (!rest.empty()) {
    const std::string_view line = take_recording_line(rest);
    if (line.empty()) continue;
    const RecordingRow row(columns, line);
    const std::string_view of(row.text({kVehicle, kVehicle}));
    if (vehicle.empty()) vehicle = of;
    if (of != vehicle) {
      builder.leave_out_source("vehicle " + std::string(of));
      continue;
    }
    take_recording_row(row, frame, origin.amsl_m, builder);
  }
  VehicleLog log = builder.finish();
  if (log.captures.empty() && !log.losses.other_sources.empty()) {
    throw DataError(name +
                    ": an AirSim recording without any picture of image type 0, Scene: record one (RecordingCameras "
                    "of settings.json: \"ImageType\": 0)");
  }
  return log;
}

}  // namespace pilotage
