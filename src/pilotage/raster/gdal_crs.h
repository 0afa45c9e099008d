#pragma once

#include <memory>
#include <optional>
#include <string>

#include <Eigen/Core>

#include "pilotage/geo/geodetic_point.h"

#pragma GCC visibility push(default)

namespace pilotage {

/// A coordinate reference system; coordinates always in the order x = easting or longitude, y = northing or latitude,
/// whatever the authority's axis order.
class Crs {
 public:
  /// Nothing: `empty()`. Every other question about it throws UsageError.
  Crs() = default;

  /// Anything GDAL understands: "EPSG:32750", WKT, a PROJ string, PROJJSON, a file with one of them. Throws UsageError.
  static Crs from_user_input(const std::string& text);
  static Crs wgs84();

  /// WKT 1 (GDAL's dialect, what GeoPackage readers know) where it says the same, else WKT 2:2019.
  const std::string& wkt() const { return wkt_; }
  bool empty() const { return wkt_.empty(); }
  std::string name() const;
  std::string authority() const;  ///< "EPSG:32750", or "" when it has none.
  bool is_projected() const;
  bool is_geographic() const;
  /// Whether heights are part of it: a compound CRS or a three-dimensional geographic CRS.
  bool has_height() const;
  double metres_per_unit() const;  ///< Of the horizontal axes; NaN for a geographic CRS.

  /// Whether both give the same point the same coordinates; names, axis order, and how it is written do not matter.
  bool same_as(const Crs& other) const;

 private:
  std::string wkt_;
};

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
