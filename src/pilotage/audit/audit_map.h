#pragma once

#include <limits>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "pilotage/audit/audit_options.h"
#include "pilotage/base/progress.h"
#include "pilotage/geo/bounds.h"
#include "pilotage/raster/gdal_crs.h"
#include "pilotage/registration/register_dates.h"

#pragma GCC visibility push(default)

namespace pilotage {

/// What becomes of a map that was held against another one.
enum class AuditVerdict {
  kWithin,    ///< 95 % of what was compared lies within the limit.
  kBeyond,    ///< It does not.
  kNotKnown,  ///< Too little of the ground that both show could be compared, or not well enough.
};

inline EnumNames<AuditVerdict> enum_names(AuditVerdict) {
  return {{AuditVerdict::kWithin, "within"}, {AuditVerdict::kBeyond, "beyond"}, {AuditVerdict::kNotKnown, "not_known"}};
}

/// A map held against another one. Ground counts as compared where a tie at the finest resolution that agrees with the
/// field around it was found as near as the next place: what is off by itself, as a part of a mosaic may be, is not
/// compared rather than taken for its neighbours. Shifts are the map's place less the other one's, of the same ground;
/// measured, and no better than both pictures agree (`registration.fit.left_out_m`).
struct MapAudit {
  AuditVerdict verdict = AuditVerdict::kNotKnown;
  Crs crs;
  Bounds area_m;  ///< Around what both show, in `crs`.
  Registration registration;
  double common_m2 = 0;                     ///< Ground that both show.
  double compared_m2 = 0;                   ///< Of it, compared.
  double compared = 0;                      ///< Share.
  Eigen::Vector2d median_shift_en_m{0, 0};  ///< Along the axes of `crs`, each axis for itself.
  std::vector<std::uint8_t>
      compared_cells;  ///< Row by row from the north-west of area_m, cells of cell_m: 1 = compared.
  int cell_columns = 0;
  double cell_m = 0;
  Spread shift_m;         ///< Length of the shift, over what was compared.
  Spread about_median_m;  ///< The same without the median shift: what no moving of the map mends.
  /// Root mean square of what the map says of its own error there, each axis (raster/map_sigma.h); NaN where it does
  /// not.
  double map_sigma_m = std::numeric_limits<double>::quiet_NaN();
  double other_sigma_m = std::numeric_limits<double>::quiet_NaN();  ///< The same of the other map, where that says it.
  std::vector<std::string> warnings;
};

/// Brings `other` onto `map` (GDAL datasets; of the other one several, later ones on top;
/// registration/register_dates.h) wherever both show ground, and judges the shift. Throws UsageError; DataError when
/// they share no ground or cannot be read; Interrupted. The same for any number of threads.
MapAudit audit_map(const std::string& map, const std::vector<std::string>& other, const AuditOptions& options,
                   int threads, const Progress& progress = {});

/// Why `audit` has no verdict, as a clause naming the numbers and options; "" when it has one.
std::string why_not_known(const MapAudit& audit, const AuditOptions& options);

}  // namespace pilotage

#pragma GCC visibility pop
