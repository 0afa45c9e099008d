#pragma once

#include <optional>
#include <string>
#include <vector>

#include "pilotage/audit/audit_map.h"
#include "pilotage/base/output_file.h"
#include "pilotage/base/progress.h"
#include "pilotage/camera/camera.h"
#include "pilotage/capture/capture_options.h"
#include "pilotage/geo/geodetic_point.h"

#pragma GCC visibility push(default)

namespace pilotage {

/// A frame of a captured map, as adjusted.
struct CapturedFrame {
  std::string file;
  std::string path;
  double time_s = 0;  ///< NaN where not known.
  GeodeticPoint measured;
  double measured_sigma_m = 0;
  GeodeticPoint adjusted;
  double agl_m = 0;  ///< Of the camera above the surface below it.
  double yaw_deg = 0;
  double pitch_deg = 0;
  double roll_deg = 0;
  double residual_east_m = 0;  ///< Measured less adjusted, without what all frames have in common.
  double residual_north_m = 0;
  double residual_up_m = 0;
  int sightings = 0;
  double rms_px = 0;          ///< Of its sightings.
  std::int64_t drawn_px = 0;  ///< Of the map, from it.
};

/// How a map was tied to another one.
struct MapAlignment {
  std::string reference;         ///< The other map.
  double reference_sigma_m = 0;  ///< Of what it misses alike, each axis; taken for granted.
  std::string sigma_source;      ///< Where that is from, as a word for people.
  int ties = 0;                  ///< That were used.
  MapAudit before;               ///< The map of the frames by themselves against it,
  MapAudit after;                ///< and the map that was written.
};

/// What capture() made, and how well the frames fit together. All numbers are measured on this block.
struct CaptureResult {
  std::vector<CapturedFrame> frames;
  std::vector<std::string> left_out;  ///< "path: why".
  std::int64_t pairs = 0;
  std::int64_t points = 0;
  std::int64_t sightings = 0;        ///< That count, of
  std::int64_t sightings_found = 0;  ///< all.
  double reprojection_rms_px = 0;
  std::string camera_source;
  double given_focal_length_px = 0;
  Camera camera;  ///< As adjusted.
  double boresight_x_deg = 0;
  double boresight_y_deg = 0;
  double boresight_z_deg = 0;
  double clock_offset_s = 0;
  double bias_east_m = 0;  ///< Known with control points or another map alone; 0 without.
  double bias_north_m = 0;
  double position_rms_m = 0;  ///< Of the frames' horizontal residuals.
  int control_points = 0;
  double control_rms_m = 0;  ///< Of where marks put them against where they were given; NaN without.
  std::string ground;        ///< What the frames were laid over.
  double ground_spread_m = 0;
  double gsd_m = 0;
  std::int64_t width_px = 0;
  std::int64_t height_px = 0;
  std::string crs;
  double area_m2 = 0;
  std::optional<MapAlignment> alignment;
  double map_sigma_median_m = 0;  ///< Of the map's own error, each axis, over what is drawn; modelled.
  double map_sigma_p95_m = 0;
  std::vector<std::string> assumptions;
  std::vector<std::string> warnings;
};

/// Makes a reference map of the frames of a camera that looked down, and writes it to `ortho` (not committed):
/// features and tracks, block adjustment, ground, orthophoto (docs/methods/capture.md), tied to the map of
/// CaptureOptions::align where one is given; and to `map_sigma` (not
/// committed; in the same folder) the map's own error, whose name stands in the map's tags (raster/map_sigma.h). The
/// same bytes for any number of threads. Throws UsageError; DataError, naming the frames, for what cannot be used or
/// contradicts itself; Interrupted.
CaptureResult capture(const std::vector<std::string>& inputs, const CaptureOptions& options, const OutputFile& ortho,
                      const OutputFile& map_sigma, int threads, const Progress& progress = {});

}  // namespace pilotage

#pragma GCC visibility pop
