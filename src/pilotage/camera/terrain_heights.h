#pragma once

#include <functional>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "pilotage/base/wide_clones.h"
#include "pilotage/camera/projection.h"
#include "pilotage/geo/geodetic_point.h"
#include "pilotage/raster/elevation.h"

namespace pilotage {

/// Heights of the ground under a camera on a grid of east and north: metres above the ground straight below it,
/// bilinear between four nodes.
class TerrainHeights {
 public:
  /// `heights_m` row by row from the south, each from west to east, `columns` (≥ 2) to a row; NaN where nothing is
  /// known. Throws UsageError unless there are two rows of them and the spacing is above 0.
  TerrainHeights(const Eigen::Vector2d& south_west_m, double spacing_m, int columns, std::vector<double> heights_m);

  /// NaN outside the grid and where one of the four nodes is not known.
  double height_m(const Eigen::Vector2d& ground_m) const;

  /// The heights at eight points, each as height_m gives it.
  void heights_m(const Together& east_m, const Together& north_m, Together& found_m) const;

  double spacing_m() const { return spacing_m_; }
  double lowest_m() const { return lowest_m_; }  ///< Of the nodes; NaN when none is known.
  double highest_m() const { return highest_m_; }
  /// No slope of the ground between the nodes is larger, metres up per metre; infinite where a node is not known.
  double steepest() const { return steepest_; }

 private:
  Eigen::Vector2d south_west_m_;
  double spacing_m_;
  int columns_;
  int rows_;
  std::vector<double> heights_m_;
  double lowest_m_;
  double highest_m_;
  double steepest_;
};

/// Samples heights (metres above the ground below the camera, as a function of east and north) wherever rays of the
/// frame may meet ground: between the point below and the footprint on ground as low as the lowest that is found so.
/// `spacing_m` apart, or wider where that would make more than 128 nodes a side: structure finer than that is lost.
TerrainHeights sample_terrain(const View& view, double spacing_m,
                              const std::function<double(const Eigen::Vector2d& ground_m)>& height_m);

/// The same from an elevation model, at the distance of its heights. Where it does not know the ground below the
/// camera nothing is known at all. Throws DataError as Elevation::amsl_m.
TerrainHeights terrain_under(const View& view, GeodeticPoint nadir, const Elevation& elevation);

/// Where the ray of `pixel` first meets ground that is not flat: east and north from the point straight below, as
/// ground_from_pixel. The ray is followed in steps of half a spacing over the heights that the grid has (those that are
/// above the steepest slope for certain are left out), and the crossing is then found to 1 mm of height above the
/// bilinear ground; a ridge that a ray cuts over less than half a spacing may be passed over. Nothing also where the
/// ray leaves the grid or comes over heights that are not known.
std::optional<Eigen::Vector2d> terrain_from_pixel(const View& view, const TerrainHeights& terrain,
                                                  const Eigen::Vector2d& pixel);

/// The same of many rays, in the camera's frame: they are followed eight at a time, to the same places as one alone.
/// NaN where a ray meets nothing. The spans are of one size.
void terrain_from_rays(const View& view, const TerrainHeights& terrain, std::span<const Eigen::Vector3d> rays_camera,
                       std::span<Eigen::Vector2d> ground_m);

}  // namespace pilotage
