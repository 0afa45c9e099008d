#include "pilotage/flightlog/frame_exif.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "pilotage/base/text.h"
#include "pilotage/geo/geodesic.h"

namespace pilotage {
namespace {

using Tags = std::map<std::string, std::string>;

constexpr double kMmPerInch = 25.4;

/// "+40.10", "40.10": XMP as DJI writes it.
std::optional<double> xmp_number(const Tags& tags, const std::string& name) {
  const auto found = tags.find(name);
  if (found == tags.end()) return std::nullopt;
  std::string_view text = found->second;
  if (text.starts_with('+')) text.remove_prefix(1);
  const auto value = parse_number(text);
  return value && std::isfinite(*value) ? value : std::nullopt;
}

/// "(46) (50) (34.3145)" or "4000": as GDAL writes EXIF. Nothing unless all of it can be read.
std::vector<double> exif_numbers(const Tags& tags, const std::string& name) {
  const auto found = tags.find(name);
  if (found == tags.end()) return {};
  std::string text = found->second;
  std::replace_if(
      text.begin(), text.end(), [](char c) { return c == '(' || c == ')'; }, ' ');
  std::vector<double> numbers;
  for (std::size_t begin = text.find_first_not_of(' '); begin != std::string::npos;) {
    const std::size_t end = text.find(' ', begin);
    const auto value = parse_number(std::string_view(text).substr(begin, end - begin));
    if (!value || !std::isfinite(*value)) return {};
    numbers.push_back(*value);
    begin = text.find_first_not_of(' ', end);
  }
  return numbers;
}

std::optional<double> exif_number(const Tags& tags, const std::string& name) {
  const std::vector<double> numbers = exif_numbers(tags, name);
  return numbers.size() == 1 ? std::optional(numbers.front()) : std::nullopt;
}

/// Degrees, minutes, seconds with N, S, E, W beside them.
std::optional<double> exif_angle(const Tags& tags, const std::string& name, char positive, char negative) {
  const std::vector<double> parts = exif_numbers(tags, name);
  const auto reference = tags.find(name + "Ref");
  if (parts.size() != 3 || reference == tags.end() || reference->second.empty()) return std::nullopt;
  const char side = reference->second.front();
  if (side != positive && side != negative) return std::nullopt;
  const double angle_deg = parts[0] + parts[1] / 60 + parts[2] / 3600;
  return side == positive ? angle_deg : -angle_deg;
}

std::optional<GeodeticPoint> checked_point(std::optional<double> lon_deg, std::optional<double> lat_deg) {
  if (!lon_deg || !lat_deg || (*lon_deg == 0 && *lat_deg == 0)) return std::nullopt;
  if (std::abs(*lon_deg) > 180 || std::abs(*lat_deg) > 90) return std::nullopt;
  return GeodeticPoint{wrap_lon_deg(*lon_deg), *lat_deg};
}

std::optional<FromTag<GeodeticPoint>> xmp_position(const ImageMetadata& metadata) {
  const auto lat_deg = xmp_number(metadata.xmp, "drone-dji:GpsLatitude");
  for (const std::string longitude : {"drone-dji:GpsLongitude", "drone-dji:GpsLongtitude"}) {
    const auto point = checked_point(xmp_number(metadata.xmp, longitude), lat_deg);
    if (point) return FromTag<GeodeticPoint>{*point, "drone-dji:GpsLatitude, " + longitude};
  }
  return std::nullopt;
}

std::optional<FromTag<GeodeticPoint>> exif_position(const ImageMetadata& metadata) {
  const auto point = checked_point(exif_angle(metadata.exif, "GPSLongitude", 'E', 'W'),
                                   exif_angle(metadata.exif, "GPSLatitude", 'N', 'S'));
  if (point) return FromTag<GeodeticPoint>{*point, "EXIF GPSLatitude, GPSLongitude"};
  return std::nullopt;
}

std::optional<FromTag<double>> find_amsl(const ImageMetadata& metadata) {
  if (const auto amsl_m = xmp_number(metadata.xmp, "drone-dji:AbsoluteAltitude")) {
    return FromTag<double>{*amsl_m, "drone-dji:AbsoluteAltitude"};
  }
  const auto altitude_m = exif_number(metadata.exif, "GPSAltitude");
  if (!altitude_m) return std::nullopt;
  const auto reference = metadata.exif.find("GPSAltitudeRef");
  const bool below = reference != metadata.exif.end() && reference->second == "0x01";
  return FromTag<double>{below ? -*altitude_m : *altitude_m, "EXIF GPSAltitude"};
}

std::optional<FromTag<Attitude>> find_attitude(const Tags& xmp, const std::string& of) {
  const auto yaw_deg = xmp_number(xmp, "drone-dji:" + of + "YawDegree");
  const auto pitch_deg = xmp_number(xmp, "drone-dji:" + of + "PitchDegree");
  const auto roll_deg = xmp_number(xmp, "drone-dji:" + of + "RollDegree");
  if (!yaw_deg || !pitch_deg || !roll_deg) return std::nullopt;
  return FromTag<Attitude>{{*yaw_deg, *pitch_deg, *roll_deg}, "drone-dji:" + of + "YawDegree, PitchDegree, RollDegree"};
}

/// The gimbal's frame has x along the view, y to the right and z down the image; a body with a camera looking down has
/// x up the image and z along the view: a turn by 90° about y.
Attitude body_of_gimbal(const Attitude& gimbal) {
  const Attitude body = attitude_of(ned_from_body(gimbal) * rotation_zyx(0, 90, 0));
  // The tags have a tenth of a degree: without the noise of the sines, straight down is 0 and 0 again.
  const auto rounded = [](double angle_deg) { return std::round(angle_deg * 1e9) / 1e9 + 0.0; };
  return {rounded(body.yaw_deg), rounded(body.pitch_deg), rounded(body.roll_deg)};
}

/// Of a picture of another size than the one the tag speaks of: the width that EXIF states over the one it has.
double width_factor(const ImageMetadata& metadata) {
  const auto full_width_px = exif_number(metadata.exif, "PixelXDimension");
  return full_width_px && *full_width_px > 0 ? metadata.width_px / *full_width_px : 1;
}

/// The 35 mm equivalent compares diagonals (CIPA DCG-001): 43.27 mm stand for the sensor's. Pictures wider than 3 : 2
/// are cut from a frame of 4 : 3 of the same width, as small drones' sensors are.
double focal_from_equivalent_px(double equivalent_mm, int width_px, int height_px) {
  const double diagonal_mm = std::hypot(36.0, 24.0);
  const double aspect = static_cast<double>(width_px) / height_px;
  const double full_height_px = aspect > 1.6 ? width_px * 0.75 : height_px;
  return equivalent_mm / diagonal_mm * std::hypot(width_px, full_height_px);
}

/// Seconds of "2026:11:21 10:20:30", by a calendar without time zones; and of the fraction that some cameras add.
std::optional<double> taken_s(const ImageMetadata& metadata) {
  const auto found = metadata.exif.find("DateTimeOriginal");
  if (found == metadata.exif.end() || found->second.size() < 19) return std::nullopt;
  const std::string& text = found->second;
  std::array<double, 6> parts{};
  constexpr std::array<std::pair<std::size_t, std::size_t>, 6> kPlaces{
      {{0, 4}, {5, 2}, {8, 2}, {11, 2}, {14, 2}, {17, 2}}};
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const auto number = parse_number(text.substr(kPlaces[i].first, kPlaces[i].second));
    if (!number) return std::nullopt;
    parts[i] = *number;
  }
  // Days since 1970 by the civil calendar, January and February counted to the year before.
  const double year = parts[0] - (parts[1] <= 2 ? 1 : 0);
  const double month = parts[1] + (parts[1] <= 2 ? 9 : -3);
  const double days = std::floor(365.25 * year) - std::floor(year / 100) + std::floor(year / 400) +
                      std::floor((153 * month + 2) / 5) + parts[2] - 1 - 719468;
  double seconds = days * 86400 + parts[3] * 3600 + parts[4] * 60 + parts[5];
  const auto fraction = metadata.exif.find("SubSecTimeOriginal");
  if (fraction != metadata.exif.end()) seconds += parse_number("0." + fraction->second).value_or(0);
  return seconds;
}

/// How much a digital zoom has enlarged the middle of the picture; 0 in EXIF means that none was used.
double digital_zoom(const ImageMetadata& metadata) {
  constexpr double kLargest = 1000;
  const double zoom = exif_number(metadata.exif, "DigitalZoomRatio").value_or(1);
  return zoom > 0 && zoom < kLargest ? zoom : 1;
}

std::optional<FromTag<double>> find_focal_length(const ImageMetadata& metadata) {
  const auto usable = [](std::optional<double> value) { return value && *value > 0; };
  const double zoom = digital_zoom(metadata);
  const std::string zoomed = zoom == 1 ? "" : ", times EXIF DigitalZoomRatio " + format_number(zoom);
  const auto calibrated_px = xmp_number(metadata.xmp, "drone-dji:CalibratedFocalLength");
  if (usable(calibrated_px)) {
    return FromTag<double>{*calibrated_px * width_factor(metadata) * zoom, "drone-dji:CalibratedFocalLength" + zoomed};
  }
  const auto focal_mm = exif_number(metadata.exif, "FocalLength");
  const auto resolution = exif_number(metadata.exif, "FocalPlaneXResolution");
  const double unit = exif_number(metadata.exif, "FocalPlaneResolutionUnit").value_or(2);
  if (usable(focal_mm) && usable(resolution) && (unit == 2 || unit == 3)) {
    const double px_per_mm = *resolution / (unit == 2 ? kMmPerInch : 10.0);
    return FromTag<double>{*focal_mm * px_per_mm * width_factor(metadata) * zoom,
                           "EXIF FocalLength, FocalPlaneXResolution" + zoomed};
  }
  const auto equivalent_mm = exif_number(metadata.exif, "FocalLengthIn35mmFilm");
  if (!usable(equivalent_mm)) return std::nullopt;
  return FromTag<double>{focal_from_equivalent_px(*equivalent_mm, metadata.width_px, metadata.height_px),
                         "EXIF FocalLengthIn35mmFilm, good to some 5 %"};
}

/// "2025-01-01;fx,fy,cx,cy,k1,k2,p1,p2,k3": the date may lack.
std::optional<FromTag<Camera>> find_lens(const ImageMetadata& metadata) {
  const auto flag = xmp_number(metadata.xmp, "drone-dji:DewarpFlag");
  const auto data = metadata.xmp.find("drone-dji:DewarpData");
  if (data == metadata.xmp.end() || flag.value_or(1) != 0) return std::nullopt;
  std::string_view text = data->second;
  text.remove_prefix(text.find(';') + 1);  // npos + 1 is 0
  std::array<double, 9> numbers{};
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const std::size_t end = std::min(text.find(','), text.size());
    const auto number = parse_number(text.substr(0, end));
    if (!number || !std::isfinite(*number)) return std::nullopt;
    numbers[i] = *number;
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  const double scale = width_factor(metadata) * digital_zoom(metadata);
  Camera camera;
  camera.width_px = metadata.width_px;
  camera.height_px = metadata.height_px;
  camera.fx_px = numbers[0] * scale;
  camera.fy_px = numbers[1] * scale;
  camera.cx_px = metadata.width_px / 2.0 + numbers[2] * scale;
  camera.cy_px = metadata.height_px / 2.0 + numbers[3] * scale;
  camera.distortion_model = DistortionModel::kBrownConrady;
  std::copy(numbers.begin() + 4, numbers.end(), camera.distortion.begin());
  if (!camera_problem(camera).empty()) return std::nullopt;
  return FromTag<Camera>{camera, "drone-dji:DewarpData"};
}

/// A receiver's own places differ by metres (RTK in one tag, not in the other); more is another place.
constexpr double kSamePlace_m = 10;

std::vector<std::string> contradictions_of(const ImageMetadata& metadata, const FrameExif& exif) {
  std::vector<std::string> warnings;
  const auto xmp = xmp_position(metadata);
  const auto gps = exif_position(metadata);
  if (xmp && gps) {
    const double apart_m = geodesic_between(xmp->value, gps->value).length_m;
    const auto text = [](const GeodeticPoint& point) {
      return "lon " + format_fixed(point.lon_deg, 6) + ", lat " + format_fixed(point.lat_deg, 6);
    };
    if (apart_m > kSamePlace_m) {
      warnings.push_back("its tags name two places, " + format_fixed(apart_m, 0) + " m apart: " + text(xmp->value) +
                         " (" + xmp->tag + "), which is taken, and " + text(gps->value) + " (" + gps->tag + ")");
    }
  }
  const double zoom = digital_zoom(metadata);
  if (zoom != 1 && exif.focal_length_px && exif.focal_length_px->tag.find("35mm") != std::string::npos) {
    warnings.push_back("EXIF DigitalZoomRatio is " + format_number(zoom) +
                       ", and whether FocalLengthIn35mmFilm counts it is not said: it is taken to; give --camera");
  }
  const auto orientation = exif_number(metadata.exif, "Orientation");
  if (orientation && *orientation > 1 && *orientation <= 8) {
    warnings.push_back("EXIF Orientation " + format_number(*orientation) +
                       " is not followed: pixels are taken as they are stored, which is how the sensor has them");
  }
  return warnings;
}

}  // namespace

FrameExif frame_exif(const ImageMetadata& metadata) {
  FrameExif exif;
  exif.width_px = metadata.width_px;
  exif.height_px = metadata.height_px;
  exif.position = xmp_position(metadata);
  if (!exif.position) exif.position = exif_position(metadata);
  if (const auto height_m = xmp_number(metadata.xmp, "drone-dji:RelativeAltitude")) {
    exif.height_m = FromTag<double>{*height_m, "drone-dji:RelativeAltitude, above the place of take-off"};
  }
  exif.amsl_m = find_amsl(metadata);
  exif.taken_s = taken_s(metadata);
  exif.camera_attitude = find_attitude(metadata.xmp, "Gimbal");
  if (exif.camera_attitude) exif.camera_attitude->value = body_of_gimbal(exif.camera_attitude->value);
  exif.flight_attitude = find_attitude(metadata.xmp, "Flight");
  exif.focal_length_px = find_focal_length(metadata);
  exif.lens = find_lens(metadata);
  exif.warnings = contradictions_of(metadata, exif);
  return exif;
}

std::optional<FromTag<Camera>> exif_camera(const FrameExif& exif) {
  if (exif.lens) return exif.lens;
  if (!exif.focal_length_px) return std::nullopt;
  Camera camera;
  camera.width_px = exif.width_px;
  camera.height_px = exif.height_px;
  camera.fx_px = camera.fy_px = exif.focal_length_px->value;
  camera.cx_px = exif.width_px / 2.0;
  camera.cy_px = exif.height_px / 2.0;
  return FromTag<Camera>{camera, exif.focal_length_px->tag};
}

std::vector<TakenField> fill_from_exif(FrameRecord& frame, const FrameExif& exif, const CameraMount& mount) {
  std::vector<TakenField> taken;
  const auto fill = [&](const char* name, double& member, double value, const std::string& tag) {
    if (!std::isnan(member)) return;
    member = value;
    taken.push_back({frame.file, name, value, tag});
  };
  if (exif.position) {
    fill("prior_lon_deg", frame.prior.lon_deg, exif.position->value.lon_deg, exif.position->tag);
    fill("prior_lat_deg", frame.prior.lat_deg, exif.position->value.lat_deg, exif.position->tag);
  }
  if (exif.height_m) fill("height_agl_m", frame.height_agl_m, exif.height_m->value, exif.height_m->tag);
  const auto& source = exif.camera_attitude ? exif.camera_attitude : exif.flight_attitude;
  if (!source) return taken;
  Attitude attitude = source->value;
  if (exif.camera_attitude && !(mount == CameraMount{})) {
    attitude =
        attitude_of(ned_from_body(attitude) * rotation_zyx(mount.yaw_deg, mount.pitch_deg, mount.roll_deg).transpose());
  }
  fill("yaw_deg", frame.attitude.yaw_deg, attitude.yaw_deg, source->tag);
  fill("pitch_deg", frame.attitude.pitch_deg, attitude.pitch_deg, source->tag);
  fill("roll_deg", frame.attitude.roll_deg, attitude.roll_deg, source->tag);
  return taken;
}

std::vector<std::string> missing_fields(const FrameRecord& frame) {
  const std::array<std::pair<const char*, double>, 7> fields{{{"prior_lon_deg", frame.prior.lon_deg},
                                                              {"prior_lat_deg", frame.prior.lat_deg},
                                                              {"prior_sigma_m", frame.prior_covariance_en_m2.sum()},
                                                              {"height_agl_m", frame.height_agl_m},
                                                              {"yaw_deg", frame.attitude.yaw_deg},
                                                              {"pitch_deg", frame.attitude.pitch_deg},
                                                              {"roll_deg", frame.attitude.roll_deg}}};
  std::vector<std::string> missing;
  for (const auto& [name, value] : fields) {
    if (std::isnan(value)) missing.emplace_back(name);
  }
  return missing;
}

}  // namespace pilotage
