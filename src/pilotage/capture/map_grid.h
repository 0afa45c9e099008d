#pragma once

#include <string>

#include "pilotage/capture/capture_options.h"
#include "pilotage/capture/ortho_mosaic.h"
#include "pilotage/raster/mission_crs.h"

namespace pilotage {

// Where a map of a block lies, and how fine it is.

/// Throws UsageError and DataError for options of a map that cannot be, as far as that is known before a frame is read.
void check_map_options(const CaptureOptions& options);

/// A rectangle in the block's frame.
struct EastNorthBounds {
  Eigen::Vector2d low{0, 0};
  Eigen::Vector2d high{0, 0};
};

/// Of what the frames show on level ground.
EastNorthBounds shown_bounds(const AdjustedBlock& block);

/// Of the cameras above the ground. Throws DataError when they come out below it.
double median_agl_m(const AdjustedBlock& block, const GroundSurface& ground);

/// That of the frames, rounded to two digits, or what is asked for. Throws UsageError for more than twice that of the
/// frames.
double map_gsd_m(const CaptureOptions& options, double frame_gsd_m);

/// What is asked for, or chosen for the bounds. Throws as choose_mission_crs and check_mission_crs.
MissionCrs map_crs(const CaptureOptions& options, const LocalFrame& local, const EastNorthBounds& bounds);

/// North-up, on multiples of the ground sample distance, around the bounds. Throws DataError when the map would be too
/// large, or its CRS does not reach there.
void place_grid(OrthoMosaic& mosaic, const EastNorthBounds& bounds);

}  // namespace pilotage
