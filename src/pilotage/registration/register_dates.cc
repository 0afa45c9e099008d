#include "pilotage/registration/register_dates.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <set>

#include "pilotage/base/error.h"
#include "pilotage/base/options.h"
#include "pilotage/raster/gdal_gray.h"
#include "pilotage/registration/warped_source.h"

namespace pilotage {
namespace {

constexpr double kDefaultGsd_m = 0.6;
constexpr double kCoarseRadius_px = 12;
constexpr int kRefineRadius_px = 6;  // three pixels of the level before
constexpr int kLastRadius_px = 4;
constexpr int kUnshadowedRadius_px = 12;  // of 1 to 2 m: as far as shadows of houses and trees reach
/// Other ground gives ties at 0.3 % (real) to 1.7 % (random texture) of the places, by chance (docs/methods).
constexpr double kLeastShare = 0.04;

/// With shadows a tie counts where it differs by less than this from the field that was found without them.
constexpr double kConfirmed_px = 1;

struct PyramidPass {
  double gsd_m;
  int radius_px;  // when a field is known from the pass before
};

/// Halving the pixel from where the search is short; the finest level twice.
std::vector<PyramidPass> make_passes(double gsd_m, const RegistrationOptions& options) {
  const double search_radius_m = options.search_radius_m;
  std::vector<PyramidPass> passes;
  double coarse_m = gsd_m;
  while (search_radius_m / coarse_m > kCoarseRadius_px) coarse_m *= 2;
  // The first without shadows has to come back from where shadows may have put it.
  const auto refine = [&](double pass_gsd_m) {
    const bool is_first_without =
        leaves_shadows_out(options.ties, pass_gsd_m) && !leaves_shadows_out(options.ties, 2 * pass_gsd_m);
    passes.push_back({pass_gsd_m, is_first_without ? kUnshadowedRadius_px : kRefineRadius_px});
  };
  for (; coarse_m > 1.5 * gsd_m; coarse_m /= 2) refine(coarse_m);
  refine(gsd_m);
  passes.push_back({gsd_m, kLastRadius_px});
  return passes;
}

int whole_radius_px(double search_radius_m, double gsd_m) {
  return std::max(kLastRadius_px, static_cast<int>(std::ceil(search_radius_m / gsd_m)) + 1);
}

/// A square may lie half outside the area, so that its edge gets ties too.
DatePair open_level(const OpenPair& open, const Bounds& wanted_m, double gsd_m, const TieOptions& options) {
  const Bounds area_m = wanted_m.grown((options.template_px / 2.0 + kCoarseRadius_px) * gsd_m);
  const GeoTransform place = GeoTransform::north_up(std::floor(area_m.min_x_m / gsd_m) * gsd_m,
                                                    std::ceil(area_m.max_y_m / gsd_m) * gsd_m, gsd_m);
  const Eigen::Vector2d corner = place.pixel_from_map({area_m.max_x_m, area_m.min_y_m});
  return open(place, static_cast<std::int64_t>(std::ceil(corner.x())),
              static_cast<std::int64_t>(std::ceil(corner.y())));
}

/// What a tie of the warped second date says of the second date itself.
void compose(const WarpField& field, std::vector<Tie>& ties) {
  for (Tie& tie : ties) {
    const Eigen::Vector2d found = tie.point_m + tie.displacement_m;
    tie.displacement_m += field.continued_m(found.x(), found.y());
  }
}

/// Where the middles of squares lie on the grid of `gsd_m`, in half pixels.
std::pair<std::int64_t, std::int64_t> half_pixel(const Eigen::Vector2d& point_m, double gsd_m) {
  return {std::llround(2 * point_m.x() / gsd_m), std::llround(2 * point_m.y() / gsd_m)};
}

/// Ties with shadows in them at places that have none without: those near the field of the ties without shadows, where
/// that is known. Only those of pixels below kShadowPixels_m were found without.
std::vector<Tie> confirmed_ties(const std::vector<Tie>& without, const DatePair& dates, const WarpField& drawn_by,
                                double gsd_m, const RegistrationOptions& options, const Wanted& wanted, int threads,
                                const Progress& progress) {
  std::vector<Tie> lit;
  std::set<std::pair<std::int64_t, std::int64_t>> taken;
  for (const Tie& tie : without) {
    if (tie.gsd_m >= kShadowPixels_m) continue;
    lit.push_back(tie);
    if (tie.gsd_m < 1.5 * gsd_m) taken.insert(half_pixel(tie.point_m, gsd_m));
  }
  const WarpFit fit = fit_warp(lit, gsd_m, options.warp);
  if (fit.field.control_m.empty()) return {};
  const Wanted free_places = [&](const Bounds& square_m) {
    const Eigen::Vector2d middle_m((square_m.min_x_m + square_m.max_x_m) / 2,
                                   (square_m.min_y_m + square_m.max_y_m) / 2);
    return (!wanted || wanted(square_m)) && !taken.contains(half_pixel(middle_m, gsd_m)) &&
           fit.field.known(middle_m.x(), middle_m.y());
  };
  TieOptions with_shadows = options.ties;
  with_shadows.shadows = TieShadows::kFollow;
  const auto field = std::make_shared<const WarpField>(drawn_by);
  TieSearch search = find_ties(dates.reference, warped_source(dates.second, field, true), kLastRadius_px, with_shadows,
                               free_places, threads, progress);
  compose(drawn_by, search.ties);
  std::erase_if(search.ties, [&](Tie& tie) {
    tie.is_confirmed = true;
    const Eigen::Vector2d miss_m = tie.displacement_m - fit.field.displacement_m(tie.point_m.x(), tie.point_m.y());
    return !(miss_m.norm() < kConfirmed_px * gsd_m);  // NaN is not
  });
  return search.ties;
}

}  // namespace

Registration register_dates(const OpenPair& open, const Bounds& area_m, double gsd_m,
                            const RegistrationOptions& options, const Wanted& wanted, int threads,
                            const Progress& progress) {
  check_options(options);
  Registration result;
  result.gsd_m = gsd_m;
  result.fit = fit_warp({}, gsd_m, options.warp);
  for (const PyramidPass& pass : make_passes(gsd_m, options)) {
    const DatePair dates = open_level(open, area_m, pass.gsd_m, options.ties);
    const bool first = result.fit.field.control_m.empty();
    const auto field = std::make_shared<const WarpField>(result.fit.field);
    TieSearch search = find_ties(dates.reference, first ? dates.second : warped_source(dates.second, field, true),
                                 first ? whole_radius_px(options.search_radius_m, pass.gsd_m) : pass.radius_px,
                                 options.ties, wanted, threads, progress);
    if (static_cast<double>(search.ties.size()) < kLeastShare * static_cast<double>(search.places)) search.ties.clear();
    compose(*field, search.ties);
    result.places = search.places;
    std::erase_if(result.ties, [&](const Tie& tie) { return tie.gsd_m < 1.5 * pass.gsd_m; });
    result.ties.insert(result.ties.begin(), search.ties.begin(), search.ties.end());
    result.fit = fit_warp(result.ties, pass.gsd_m, options.warp);
  }
  if (leaves_shadows_out(options.ties, gsd_m)) {
    const std::vector<Tie> more = confirmed_ties(result.ties, open_level(open, area_m, gsd_m, options.ties),
                                                 result.fit.field, gsd_m, options, wanted, threads, progress);
    result.ties.insert(result.ties.begin(), more.begin(), more.end());
    result.fit = fit_warp(result.ties, gsd_m, options.warp);
  }
  result.finest_ties =
      std::count_if(result.ties.begin(), result.ties.end(), [&](const Tie& tie) { return tie.gsd_m < 1.5 * gsd_m; });
  if (result.places == 0) throw DataError("the second date shows no ground that the reference shows");
  return result;
}

std::string shadows_assumption(const RegistrationOptions& options, double gsd_m) {
  return leaves_shadows_out(options.ties, gsd_m)
             ? "ground outside of shadows decides where both lie: what is darker than its surroundings was left out or "
               "agreed with the rest"
             : "shadows fall alike in both; where they do not, the shift of tall things is that of their shadows";
}

std::vector<std::size_t> agreeing_finest_ties(const Registration& registration) {
  constexpr double kFinest = 1.5;  // levels are twice as fine as those before
  std::vector<std::size_t> numbers;
  for (std::size_t i = 0; i < registration.ties.size(); ++i) {
    if (registration.fit.outlier[i] == 0 && registration.ties[i].gsd_m <= kFinest * registration.gsd_m) {
      numbers.push_back(i);
    }
  }
  return numbers;
}

double registration_gsd_m(const std::vector<ImageryInfo>& infos, const RegistrationOptions& options) {
  if (options.gsd_m) return *options.gsd_m;
  double gsd_m = kDefaultGsd_m;
  for (const ImageryInfo& info : infos) gsd_m = std::max({gsd_m, info.gsd_x_m, info.gsd_y_m});
  return gsd_m;
}

OpenPair open_rasters(const std::vector<std::string>& reference, const ImageryOptions& reference_options,
                      const std::vector<std::string>& second, const Crs& crs) {
  return [=](const GeoTransform& map_from_pixel, std::int64_t width_px, std::int64_t height_px) {
    return DatePair{
        open_gray_on_grid(reference, crs, map_from_pixel, width_px, height_px, reference_options),
        open_gray_on_grid(second, crs, map_from_pixel, width_px, height_px, second_date_options(reference_options))};
  };
}

}  // namespace pilotage
