#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

namespace pilotage::testing {

/// A thing on a made-up ground of half a metre a pixel; metres east and south of its north-west corner, which is
/// (500000, 5000000) in UTM zone 33.
struct GroundThing {
  Eigen::Vector2d center_m{0, 0};
  double length_m = 20;
  double width_m = 20;
  double heading_deg = 0;  ///< Of the length, clockwise from the top.
  bool disc = true;        ///< Else a rectangle.
};

inline constexpr double kGroundGsd_m = 0.5;

/// Things on a regular lattice with random places, sizes (16 to 26 m) and, for bars of a third of their length,
/// headings.
std::vector<GroundThing> scattered(int columns, int rows, bool discs, std::uint64_t seed);

/// Noise with gray squares that are no landmarks, and the things as bright on it as a date has it.
cv::Mat draw_ground(const std::vector<GroundThing>& things, int side_px, double brightness, std::uint64_t seed);

/// Writes a ground as GeoTIFF and returns its name.
std::string write_ground(const std::filesystem::path& path, const cv::Mat& gray);

/// Writes things as GeoJSON: discs as points with a diameter, bars as polygons. Returns its name.
std::string write_things(const std::filesystem::path& path, const std::vector<GroundThing>& things,
                         const std::string& class_name);

/// "[lon, lat]" of a place on the ground.
std::string ground_place(const Eigen::Vector2d& place_m);

}  // namespace pilotage::testing
