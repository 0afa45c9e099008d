#pragma once

#include <memory>
#include <optional>
#include <string>

#include <Eigen/Core>

#include "pilotage/geo/geodetic_point.h"
#include "pilotage/raster/crs.h"

#pragma GCC visibility push(default)

namespace pilotage {

/// Points between a CRS (its horizontal part) and WGS 84 longitude and latitude. Not thread-safe: one object per
/// thread.
class CrsTransform {
 public:
  /// Throws DataError when PROJ knows no way between the two.
  explicit CrsTransform(const Crs& crs);
  ~CrsTransform();
  CrsTransform(CrsTransform&&) noexcept;
  CrsTransform& operator=(CrsTransform&&) noexcept;

  /// Nothing when the point has no image (outside the projection's domain).
  std::optional<Eigen::Vector2d> map_from_geodetic(GeodeticPoint point) const;
  /// lon in [-180, 180).
  std::optional<GeodeticPoint> geodetic_from_map(const Eigen::Vector2d& point) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Heights of a CRS that has them (Crs::has_height) → metres above mean sea level, by EGM96 (EPSG:5773). Not
/// thread-safe.
class HeightTransform {
 public:
  /// Throws DataError when PROJ knows no way without guessing, for instance because a geoid grid is not installed.
  explicit HeightTransform(const Crs& crs);
  ~HeightTransform();
  HeightTransform(HeightTransform&&) noexcept;
  HeightTransform& operator=(HeightTransform&&) noexcept;

  /// `point` in the CRS, `height` in its vertical unit; nothing outside the domain.
  std::optional<double> amsl_m(const Eigen::Vector2d& point, double height) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace pilotage

#pragma GCC visibility pop
