#pragma once

#include <optional>
#include <string>
#include <vector>

#include "pilotage/geo/geodetic_point.h"
#include "pilotage/raster/crs.h"

namespace pilotage {

/// How PROJ brings a CRS to WGS 84 at a place.
struct DatumShift {
  std::string operation;             ///< PROJ's name of it: "NAD27 to WGS 84 (6)".
  std::optional<double> accuracy_m;  ///< As the registry says; nothing where it says none, or where no datum changes.
  bool ballpark = false;             ///< The datum is not changed at all: PROJ can do none here.
  std::string missing_grid;          ///< That a better one needs and is not installed; "" where there is none.
  std::optional<double> accuracy_with_grid_m;
};

/// From this accuracy on a change of datum is spoken of, and counts in the error of the map.
inline constexpr double kDatumAccuracySaid_m = 3;

/// The operation that is taken at a place. What is found is remembered by CRS and degree. Throws DataError when PROJ
/// cannot read the CRS.
DatumShift datum_shift(const Crs& crs, GeodeticPoint place);

/// The name of the CRS's ellipsoid where it names no datum ("Bessel 1841") and is not near WGS 84; else "".
std::string ellipsoid_without_datum(const Crs& crs);

/// What a CRS has to do with WGS 84, by its names.
enum class NearWgs84 {
  kSame,  ///< Its datum is called so, or it has none and the ellipsoid is.
  kNear,  ///< Another datum, or none, on the ellipsoid of GRS 1980: WGS 84 is known within it to a metre or two.
  kFar,
};
NearWgs84 near_wgs84(const Crs& crs);

/// A datum on such an ellipsoid that is in use at a place, and how far WGS 84 would be from where it is, were the
/// coordinates of WGS 84 taken for its own.
struct PossibleDatum {
  std::string name;
  double shift_m = 0;
};
std::vector<PossibleDatum> possible_datums(const std::string& ellipsoid, GeodeticPoint place);

}  // namespace pilotage
