#pragma once

#include <vector>

#include <Eigen/Core>

namespace pilotage {

/// Heights of the ground as scattered points know them: a plane by least squares, and what is left of it smoothed over
/// a lattice, first widely, then twice over kHeightCellPx (normalised convolution: H. Knutsson, C.-F. Westin,
/// "Normalized and differential convolution", CVPR 1993). Where no points are near it is the plane of all; so nothing
/// leans to where the points happen to be.
class GroundHeights {
 public:
  GroundHeights() = default;
  /// Positions in pixels, heights in metres, one for each; heights that are NaN are left out. Slopes of the plane are
  /// held level as by one more point for each, `level_px` off.
  GroundHeights(const std::vector<Eigen::Vector2d>& places_px, const std::vector<double>& heights_m,
                double level_px = 1);

  bool known() const { return columns_ > 0; }
  /// Metres; NaN unless known(). Beyond the points it is the height at the nearest place of their bounding box: a slope
  /// does not go on for ever.
  double height_m(const Eigen::Vector2d& place_px) const;

 private:
  /// Of the lattice alone, bilinear between the middles of cells.
  double smoothed_m(const Eigen::Vector2d& place_px) const;
  double plane_m(const Eigen::Vector2d& place_px) const;

  Eigen::Vector2d low_px_{0, 0};
  Eigen::Vector2d high_px_{0, 0};
  Eigen::Vector3d plane_{0, 0, 0};  ///< Height at low_px_, and its slope in metres per pixel.
  int columns_ = 0;
  int rows_ = 0;
  std::vector<float> cells_m_;  ///< Above the plane, row by row.
};

/// Side of a cell.
inline constexpr double kHeightCellPx = 16;

/// Bytes that heights of points within a square of this side take at most.
double ground_heights_bytes(double side_px);

}  // namespace pilotage
