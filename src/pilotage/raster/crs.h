#pragma once

#include <string>

#pragma GCC visibility push(default)

namespace pilotage {

/// A coordinate reference system; coordinates always in the order x = easting or longitude, y = northing or latitude,
/// whatever the authority's axis order. A value that any source of pixels can carry; its questions are answered by
/// pilotage::prep alone (gdal_crs.cc).
class Crs {
 public:
  /// Nothing: `empty()`. Every other question about it throws UsageError.
  Crs() = default;

  /// Anything GDAL understands: "EPSG:32750", WKT, a PROJ string, PROJJSON; neither files nor addresses. Throws
  /// UsageError.
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

}  // namespace pilotage

#pragma GCC visibility pop
