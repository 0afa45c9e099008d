#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "pilotage/base/progress.h"
#include "pilotage/geo/bounds.h"
#include "pilotage/raster/gdal_crs.h"
#include "pilotage/raster/gdal_imagery.h"
#include "pilotage/registration/fit_warp.h"

#pragma GCC visibility push(default)

namespace pilotage {

/// Two dates of the same ground as sources on one grid.
struct DatePair {
  GraySource reference;
  GraySource second;
};

/// Opens both dates on a north-up grid of square pixels.
using OpenPair = std::function<DatePair(const GeoTransform& map_from_pixel, std::int64_t width, std::int64_t height)>;

struct Registration {
  double gsd_m = 0;         ///< That was correlated at last.
  std::int64_t places = 0;  ///< With ground in both dates.
  std::vector<Tie> ties;    ///< Of all levels, the finest first.
  std::int64_t finest_ties = 0;
  WarpFit fit;
};

/// Brings a second date onto the reference over `area_m` (CRS of the grid, metres). From coarse to fine: ties at a
/// ground sample distance where search_radius_m is about twelve pixels, a warp through them, ties at twice the
/// resolution between the reference and the warped second date, and so on to `gsd_m`; there once more, so that what is
/// correlated at last agrees to a fraction of a pixel. Each level's displacement is composed with the one before. The
/// warp goes through the ties of all levels, each with an error of half its own pixel: coarse ones, from larger
/// squares, hold where fine texture has changed, as forest does. Where shadows are left out (leaves_shadows_out),
/// places without a tie are looked at once more at last, with shadows: ties that lie within a pixel of the field of
/// those without are taken, too (Tie::is_confirmed). A level with ties at less than 4 % of its places counts as one
/// without: so many come about by chance. Throws as find_ties; DataError when the dates share no ground in the area.
Registration register_dates(const OpenPair& open, const Bounds& area_m, double gsd_m,
                            const RegistrationOptions& options, const Wanted& wanted = {}, int threads = 0,
                            const Progress& progress = {});

/// What a registration to pixels of `gsd_m` takes for granted of shadows, for people.
std::string shadows_assumption(const RegistrationOptions& options, double gsd_m);

/// The ties at the finest resolution that agree with the field: their numbers in registration.ties.
std::vector<std::size_t> agreeing_finest_ties(const Registration& registration);

/// The ground sample distance to correlate at: options.gsd_m, else 0.6 m or that of the coarsest raster.
double registration_gsd_m(const std::vector<ImageryInfo>& infos, const RegistrationOptions& options);

/// Both dates from rasters of any CRS and resolution, on a grid in `crs`.
OpenPair open_rasters(const std::vector<std::string>& reference, const ImageryOptions& reference_options,
                      const std::vector<std::string>& second, const Crs& crs);

}  // namespace pilotage

#pragma GCC visibility pop
