#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "pilotage/geo/geodetic_point.h"

namespace pilotage {

/// A value that an elevation model holds where it has no height, without declaring it.
struct UndeclaredVoid {
  double stored = 0;  ///< As the band has it.
  /// No ground has that height (beyond 9,000 m, below the sea's floor; -32768, -32767, -9999 and -999 below any land):
  /// it is taken for no height. Else a value that may be a height as well (0, -99), of which most have steps of more
  /// than 20 m to their neighbours: it is taken for ground.
  bool certain = false;
  std::int64_t pixels = 0;
  std::int64_t looked_at = 0;  ///< Of so many with a value.
  GeodeticPoint first;         ///< One of them.
};

/// The same as a sentence, with what to do.
std::string undeclared_void_text(const std::string& dataset, const UndeclaredVoid& found);

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
  /// over the outer half pixel). NaN outside the raster and where one of the four is no data, declared or by a value
  /// that no ground has (UndeclaredVoid::certain). Throws DataError when the data cannot be read.
  double amsl_m(GeodeticPoint point) const;

  const std::string& dataset() const;
  /// What the heights were taken for, as a sentence for the planner: transformed to EGM96 when the CRS tells its
  /// vertical datum and PROJ has the grid for it, assumed to be above mean sea level otherwise.
  const std::string& vertical_datum() const;
  bool datum_assumed() const;  ///< The latter.
  /// What the model holds where it has no height, without saying so: looked for in all of it, or, of models of more
  /// than some 4 million heights, around these points. Throws DataError when the data cannot be read.
  std::vector<UndeclaredVoid> undeclared_voids(std::span<const GeodeticPoint> around) const;
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
