#pragma once

#include <optional>
#include <string>
#include <vector>

#include "pilotage/camera/attitude.h"
#include "pilotage/camera/camera.h"
#include "pilotage/geo/geodetic_point.h"
#include "pilotage/mission/frame_table.h"
#include "pilotage/raster/gdal_image_metadata.h"

namespace pilotage {

/// A value that came out of a picture, and from which of its tags.
template <class Value>
struct FromTag {
  Value value;
  std::string tag;
};

/// What a drone's picture says of how it was taken: EXIF, and XMP as DJI writes it (namespace
/// http://www.dji.com/drone-dji/1.0/). Absent is what has no tag, or a tag that cannot be read.
struct FrameExif {
  /// drone-dji:GpsLatitude and GpsLongitude (also under DJI's misspelt GpsLongtitude), else EXIF's GPS position.
  /// 0°, 0° stands for "no position".
  std::optional<FromTag<GeodeticPoint>> position;
  /// drone-dji:RelativeAltitude: above the place of take-off.
  std::optional<FromTag<double>> height_m;
  /// drone-dji:AbsoluteAltitude, else EXIF's GPSAltitude: above mean sea level, as receivers give it.
  std::optional<FromTag<double>> amsl_m;
  /// EXIF's DateTimeOriginal with its fraction, by the camera's own clock: seconds since 1970 by a calendar without
  /// time zones.
  std::optional<double> taken_s;
  /// drone-dji:GimbalYawDegree, GimbalPitchDegree, GimbalRollDegree: attitude of the camera itself, here as that of an
  /// aircraft whose camera looks straight down (CameraMount{}): gimbal pitch −90, roll 0 is pitch 0, roll 0.
  std::optional<FromTag<Attitude>> camera_attitude;
  /// drone-dji:FlightYawDegree, FlightPitchDegree, FlightRollDegree: attitude of the aircraft.
  std::optional<FromTag<Attitude>> flight_attitude;
  /// Focal length, in pixels, of the picture as it is, from the best tag there is: drone-dji:CalibratedFocalLength;
  /// FocalLength with FocalPlaneXResolution, both times DigitalZoomRatio; FocalLengthIn35mmFilm, in which a digital
  /// zoom is counted or not, as the maker chose.
  std::optional<FromTag<double>> focal_length_px;
  /// drone-dji:DewarpData of a picture that the camera has not corrected (DewarpFlag 0): focal lengths, principal point
  /// as an offset from the middle, k1, k2, p1, p2, k3.
  std::optional<FromTag<Camera>> lens;
  /// What its tags contradict each other in, or say that is not followed: sentences.
  std::vector<std::string> warnings;
  int width_px = 0;
  int height_px = 0;
};

FrameExif frame_exif(const ImageMetadata& metadata);

/// The lens of the tags, else an ideal camera with that focal length and the principal point in the middle; nothing
/// without either.
std::optional<FromTag<Camera>> exif_camera(const FrameExif& exif);

/// A number that was taken from a picture.
struct TakenField {
  std::string file;   ///< Of the frame, as the record has it.
  std::string field;  ///< "yaw_deg".
  double value = 0;
  std::string tag;
};

/// Fills what `frame` does not have (NaN) of prior, height_agl_m and attitude, and returns what was taken. The attitude
/// is the gimbal's, brought to the aircraft that carries the camera at `mount`, else the flight's.
std::vector<TakenField> fill_from_exif(FrameRecord& frame, const FrameExif& exif, const CameraMount& mount);

/// The names of the fields among prior_lon_deg, prior_lat_deg, prior_sigma_m, height_agl_m, yaw_deg, pitch_deg,
/// roll_deg that `frame` does not have (NaN).
std::vector<std::string> missing_fields(const FrameRecord& frame);

}  // namespace pilotage
