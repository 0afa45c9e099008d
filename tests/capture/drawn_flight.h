#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "pilotage/camera/camera.h"
#include "pilotage/capture/capture.h"
#include "pilotage/geo/geodetic_point.h"
#include "pilotage/raster/gdal_crs.h"
#include "pilotage/raster/raster.h"

namespace pilotage::testing {

/// A frame of a drawn flight: the truth, and what its table says.
struct DrawnFrame {
  std::string file;
  GeodeticPoint nadir;   ///< True.
  GeodeticPoint stated;  ///< As measured.
  double height_m = 0;   ///< True, above the ground at 0 m.
  double yaw_deg = 0;
  double pitch_deg = 0;
  double roll_deg = 0;
};

/// Four lines of five frames over ground of fine gray texture with a hill of `hill_m`: tilted by up to 3°, every second
/// line flown back, measured to within `position_sigma_m`.
struct DrawnFlight {
  Raster ground;  ///< CV_8UC1, 0.25 m.
  Crs crs;
  Camera camera;
  std::vector<DrawnFrame> frames;
};

DrawnFlight draw_flight(const std::filesystem::path& folder, double hill_m, double position_sigma_m);

/// Height of the ground at metres east and north of the grid's middle: a hill.
double height_of_ground_m(const Eigen::Vector2d& en_m, double hill_m);

/// gcp_list.txt of points at metres east and north of the grid's middle, with a mark in each frame that sees them;
/// `moved_m` is added to the easting of the last point.
std::filesystem::path write_control_points(const std::filesystem::path& folder, const DrawnFlight& flight,
                                           const std::vector<Eigen::Vector2d>& points_en_m, double hill_m,
                                           double moved_m);

/// The true ground as a map, all of it `east_m` too far east.
std::filesystem::path write_ground(const std::filesystem::path& map, const DrawnFlight& flight, double east_m);

/// frames.csv of the flight in `folder`; with attitude, or with positions and heights alone.
std::filesystem::path write_table(const std::filesystem::path& folder, const std::vector<DrawnFrame>& frames,
                                  bool with_attitude);

/// For the flight: its camera, positions good to 0.3 m and heights to 1 m.
CaptureOptions options_of(const DrawnFlight& flight);

/// The map of a table's frames, and beside it its own error.
CaptureResult capture_to(const std::filesystem::path& map, const std::filesystem::path& table,
                         const CaptureOptions& options, int threads = 0);

/// How far the adjusted frames of the whole flight lie from where they were, metres.
double worst_frame_m(const DrawnFlight& flight, const CaptureResult& done);

/// How far a map's pixels lie from the ground they show, metres: patches of the true ground are looked for in the map
/// around their place.
std::vector<double> misplacements_m(const DrawnFlight& flight, const std::filesystem::path& map);

}  // namespace pilotage::testing
