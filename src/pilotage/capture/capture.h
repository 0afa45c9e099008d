#pragma once

#include <optional>
#include <string>
#include <vector>

#include "pilotage/audit/audit_map.h"
#include "pilotage/base/options.h"
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

/// A surveyed point that took no part in the adjustment, against where the map shows it.
struct CheckedPoint {
  std::string name;
  std::string file;      ///< The frame whose mark was looked at.
  bool is_shown = true;  ///< Whether the map shows that frame there; else it is the nearest that has a mark.
  double miss_east_m = 0;
  double miss_north_m = 0;
  double map_sigma_m = 0;  ///< What the map says of its own error there, each axis; modelled.
};

/// Where the standard deviation of another map's place is from.
enum class ReferenceSigma {
  kGiven,
  kSaid,   ///< By the map itself (raster/map_sigma.h).
  kTaken,  ///< kUnknownMapSigma_m: it says nothing.
};

inline EnumNames<ReferenceSigma> enum_names(ReferenceSigma) {
  return {{ReferenceSigma::kGiven, "given"},
          {ReferenceSigma::kSaid, "as it says itself"},
          {ReferenceSigma::kTaken, "taken for granted"}};
}

/// How a map was tied to another one.
struct MapAlignment {
  std::string reference;         ///< The other map.
  double reference_sigma_m = 0;  ///< Of what it misses alike, each axis; taken for granted.
  ReferenceSigma sigma_source = ReferenceSigma::kTaken;
  double counted_sigma_m = 0;  ///< What it counted as: more where ties showed that it is bent.
  int ties = 0;                ///< That were used.
  double tie_rms_m = 0;        ///< By how much they miss, each axis, without what all miss alike; robust.
  MapAudit before;             ///< The map of the frames by themselves against it,
  MapAudit after;              ///< and the map that was written.
};

/// What capture() made, and how well the frames fit together. All numbers are measured on this block.
struct CaptureResult {
  std::vector<CapturedFrame> frames;
  std::vector<std::string> left_out;  ///< "path: why".
  std::int64_t frames_given = 0;      ///< With those that are left out.
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
  double bias_east_m = 0;  ///< Without control points as far as the priors tell it from tilts of all frames.
  double bias_north_m = 0;
  double position_ratio = 0;  ///< Root mean square of residuals over what each frame's position states, each axis.
  std::int64_t contradicted_positions = 0;  ///< Not counted in either.
  double position_rms_m = 0;                ///< Of the frames' horizontal residuals.
  int control_points = 0;
  double control_rms_m = 0;    ///< Of where marks put them against where they were given; NaN without.
  double control_sigma_m = 0;  ///< Stated of them, each axis.
  std::vector<CheckedPoint> check_points;
  double check_rms_m = 0;  ///< Of their misses, each axis; NaN without.
  double check_ratio = 0;  ///< Root mean square of misses over what the map says there, each axis; NaN without.
  std::string ground;      ///< What the frames were laid over.
  double ground_spread_m = 0;
  double gsd_m = 0;
  std::int64_t width_px = 0;
  std::int64_t height_px = 0;
  std::string crs;
  double area_m2 = 0;
  std::optional<MapAlignment> alignment;
  double map_sigma_median_m = 0;  ///< Of the map's own error, each axis, over what is drawn; modelled.
  double map_sigma_p95_m = 0;
  double frames_seen_median = 0;  ///< By how many frames a place of the map is seen.
  double seen_by_three = 0;       ///< Share of the map that three frames see, or more.
  std::vector<std::string> assumptions;
  std::vector<std::string> warnings;
};

/// Makes a reference map of the frames of a camera that looked down, and writes it to `ortho` (not committed):
/// features and tracks, block adjustment, ground, orthophoto (docs/methods/capture.md), tied to the map of
/// CaptureOptions::align where one is given; and to `map_sigma` (not committed; in the same folder) the map's own
/// error, whose name stands in the map's tags (raster/map_sigma.h). The same bytes for any number of threads, and
/// whatever the folder CaptureOptions::matches held. Throws UsageError; DataError, naming the frames, for what cannot
/// be used or contradicts itself, and when that folder cannot be written to; Interrupted.
CaptureResult capture(const std::vector<std::string>& inputs, const CaptureOptions& options, const OutputFile& ortho,
                      const OutputFile& map_sigma, int threads, const Progress& progress = {});

}  // namespace pilotage

#pragma GCC visibility pop
