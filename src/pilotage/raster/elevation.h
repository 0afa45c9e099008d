#pragma once

#include <memory>
#include <string>
#include <vector>

#include "pilotage/geo/geodetic_point.h"

namespace pilotage {

/// An elevation model: any raster GDAL opens, one band of heights in any CRS. Not thread-safe: it keeps the blocks it
/// read last; use one object per thread.
class Elevation {
 public:
  /// `crs` stands in for a raster that states none. Throws DataError as inspect_imagery.
  explicit Elevation(const std::string& dataset, const std::string& crs = "");
  ~Elevation();
  Elevation(Elevation&&) noexcept;
  Elevation& operator=(Elevation&&) noexcept;

  /// Height of the ground above mean sea level, bilinear between the four pixel centres around the point (held constant
  /// over the outer half pixel). NaN outside the raster and where one of the four is no data. Throws DataError when the
  /// data cannot be read.
  double amsl_m(GeodeticPoint point) const;

  const std::string& dataset() const;
  /// What the heights were taken for, as a sentence for the planner: transformed to EGM96 when the CRS tells its
  /// vertical datum and PROJ has the grid for it, assumed to be above mean sea level otherwise.
  const std::string& vertical_datum() const;
  /// Ground distance between neighbouring heights, metres (the larger of both directions).
  double resolution_m() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// An orthophoto in place of an elevation model would make steep ground of bright roofs. Throws UsageError when
/// `elevation` is one of the `imagery`, DataError when it has bands of colours or a palette, and as inspect_imagery. ""
/// is none, and passes.
void refuse_imagery_as_elevation(const std::string& elevation, const std::vector<std::string>& imagery);

}  // namespace pilotage
