#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "pilotage/geo/bounds.h"
#include "pilotage/geo/geodetic_point.h"
#include "pilotage/geo/tile_matrix.h"
#include "pilotage/raster/raster.h"

// The only file pair that includes GDAL. Everything a stage needs of GDAL, OGR rasters and PROJ is wrapped here once, and
// GDAL's errors become DataError with the dataset's name.

namespace pilotage {

/// A coordinate reference system; coordinates always in the order x = easting or longitude, y = northing or latitude.
class Crs {
 public:
  /// Anything GDAL understands: "EPSG:32750", WKT, a PROJ string, PROJJSON. Throws UsageError.
  static Crs from_user_input(const std::string& text);
  static Crs wgs84();

  const std::string& wkt() const { return wkt_; }  ///< WKT 2 where needed, WKT 1 (GDAL) where it can be said.
  std::string name() const;
  std::string authority() const;  ///< "EPSG:32750", or "" when it has none.
  bool is_projected() const;
  bool is_geographic() const;
  double metres_per_unit() const;  ///< Of the horizontal axes; NaN for a geographic CRS.

 private:
  std::string wkt_;
};

/// Points between a CRS and WGS 84 longitude and latitude. Not thread-safe: one object per thread.
class CrsTransform {
 public:
  explicit CrsTransform(const Crs& crs);
  ~CrsTransform();
  CrsTransform(CrsTransform&&) noexcept;
  CrsTransform& operator=(CrsTransform&&) noexcept;

  /// Nothing when the point has no image (outside the projection's domain).
  std::optional<Eigen::Vector2d> map_from_geodetic(GeodeticPoint point) const;
  std::optional<GeodeticPoint> geodetic_from_map(const Eigen::Vector2d& point) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace pilotage
