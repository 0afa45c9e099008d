#include "pilotage/audit/audit_map.h"

#include <algorithm>
#include <cmath>

#include <opencv2/core.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/nan.h"
#include "pilotage/base/statistics.h"
#include "pilotage/base/text.h"
#include "pilotage/base/utf8.h"
#include "pilotage/base/wording.h"
#include "pilotage/raster/gdal_gray.h"
#include "pilotage/raster/map_sigma.h"
#include "pilotage/raster/mission_crs.h"

namespace pilotage {
namespace {

/// Side of the squares in which shifts are counted, at most so many along the longer side of the ground.
constexpr double kCell_m = 10;
constexpr double kMostCells = 1000;

std::vector<ImageryInfo> inspect_all(const std::vector<std::string>& datasets, const ImageryOptions& options,
                                     const Progress& progress) {
  std::vector<ImageryInfo> infos;
  for (const std::string& dataset : datasets) infos.push_back(inspect_imagery(dataset, options, progress));
  return infos;
}

/// For the ground around the middle of the map.
MissionCrs audit_crs(const AuditOptions& options, const ImageryInfo& info) {
  const double half_width_m = info.width_px * info.gsd_x_m / 2;
  const double half_height_m = info.height_px * info.gsd_y_m / 2;
  const std::vector<GeodeticPoint> middle{info.center};
  const double half_m = std::hypot(half_width_m, half_height_m);
  if (options.crs.empty()) return choose_mission_crs(middle, half_m);
  return check_mission_crs(Crs::from_user_input(options.crs), middle, half_m);
}

/// Where both show ground, cell by cell.
struct CommonGround {
  GeoTransform map_from_cell;
  double cell_m = kCell_m;
  cv::Mat both;  ///< CV_8U.
};

CommonGround common_ground(const std::string& map, const std::vector<std::string>& other, const ImageryOptions& options,
                           const Crs& crs, const Bounds& area_m) {
  CommonGround common;
  const double longer_m = std::max(area_m.width_m(), area_m.height_m());
  const double shorter_m = std::min(area_m.width_m(), area_m.height_m());
  common.cell_m = std::max(std::min(kCell_m, shorter_m / 8), longer_m / kMostCells);
  common.map_from_cell = GeoTransform::north_up(area_m.min_x_m, area_m.max_y_m, common.cell_m);
  const int columns = std::max(1, static_cast<int>(area_m.width_m() / common.cell_m));
  const int rows = std::max(1, static_cast<int>(area_m.height_m() / common.cell_m));
  const GraySource of_map = open_valid_on_grid({map}, crs, common.map_from_cell, columns, rows, options);
  const GraySource of_other =
      open_valid_on_grid(other, crs, common.map_from_cell, columns, rows, second_date_options(options));
  const PixelWindow all{0, 0, columns, rows};
  common.both = of_map.read(all).valid & of_other.read(all).valid;
  return common;
}

/// What a map says of its own error, over the ground that both show.
double said_sigma_m(const std::vector<ImageryInfo>& map, const Crs& crs, const CommonGround& common,
                    std::vector<std::string>& warnings) try {
  std::vector<std::string> rasters;
  for (const ImageryInfo& info : map) {
    if (info.map_sigma.empty()) continue;
    if (map_sigma_exists(info.map_sigma)) {
      rasters.push_back(info.map_sigma);
    } else {
      warnings.push_back(info.dataset + ": says that its own error stands in " + name_as_utf8(info.map_sigma) +
                         ", which does not exist");
    }
  }
  if (rasters.empty()) return kNaN;
  const GraySource source = open_map_sigma(rasters, crs, common.map_from_cell, common.both.cols, common.both.rows);
  Raster sigmas_m = source.read({0, 0, common.both.cols, common.both.rows});
  sigmas_m.valid = sigmas_m.valid & common.both;
  return mean_map_sigma_m(sigmas_m, name_as_utf8(join(rasters, ", "))).value_or(kNaN);
} catch (const DataError& error) {
  warnings.push_back(error.what());  // the verdict does not need it
  return kNaN;
}

/// Whether a square that is correlated fits into the ground.
bool square_fits(const MapAudit& audit, const TieOptions& ties) {
  return std::min(audit.area_m.width_m(), audit.area_m.height_m()) >=
         ties.min_valid_fraction * ties.template_px * audit.registration.gsd_m;
}

/// Cells around a tie at the finest resolution that agrees with the field.
cv::Mat compared_cells(const CommonGround& common, const Registration& registration, const TieOptions& options) {
  cv::Mat compared(common.both.size(), CV_8U, cv::Scalar(0));
  const double half_m = options.spacing_px * registration.gsd_m;  // as far as the next place
  for (const std::size_t number : agreeing_finest_ties(registration)) {
    const Tie& tie = registration.ties[number];
    const Eigen::Vector2d corner = common.map_from_cell.pixel_from_map(tie.point_m + Eigen::Vector2d(-half_m, half_m));
    const int side = std::max(1, static_cast<int>(std::lround(2 * half_m / common.cell_m)));
    const cv::Rect square(static_cast<int>(std::lround(corner.x())), static_cast<int>(std::lround(corner.y())), side,
                          side);
    const cv::Rect inside = square & cv::Rect(0, 0, compared.cols, compared.rows);
    if (inside.area() > 0) compared(inside).setTo(1);
  }
  return compared & (common.both / 255);
}

void judge(const CommonGround& common, const AuditOptions& options, MapAudit& audit) {
  const WarpField& field = audit.registration.fit.field;
  const cv::Mat compared = compared_cells(common, audit.registration, options.registration.ties);
  audit.compared_cells.assign(compared.begin<std::uint8_t>(), compared.end<std::uint8_t>());
  audit.cell_columns = compared.cols;
  audit.cell_m = common.cell_m;
  std::vector<Eigen::Vector2d> shifts_m;
  std::vector<double> east_m;
  std::vector<double> north_m;
  std::vector<double> lengths_m;
  for (int row = 0; row < common.both.rows; ++row) {
    for (int col = 0; col < common.both.cols; ++col) {
      if (common.both.at<std::uint8_t>(row, col) == 0) continue;
      audit.common_m2 += common.cell_m * common.cell_m;
      const Eigen::Vector2d point_m = common.map_from_cell.map_from_pixel({col + 0.5, row + 0.5});
      const Eigen::Vector2d shift_m = -field.displacement_m(point_m.x(), point_m.y());
      if (compared.at<std::uint8_t>(row, col) == 0 || shift_m.hasNaN()) continue;
      audit.compared_m2 += common.cell_m * common.cell_m;
      shifts_m.push_back(shift_m);
      east_m.push_back(shift_m.x());
      north_m.push_back(shift_m.y());
      lengths_m.push_back(shift_m.norm());
    }
  }
  audit.compared = audit.compared_m2 / audit.common_m2;
  audit.shift_m = spread_of(lengths_m);
  audit.verdict = AuditVerdict::kNotKnown;
  if (shifts_m.empty()) {
    audit.median_shift_en_m.setConstant(kNaN);
    audit.about_median_m = spread_of({});
    return;
  }
  audit.median_shift_en_m = {quantile(east_m, 0.5), quantile(north_m, 0.5)};
  std::vector<double> about_m;
  for (const Eigen::Vector2d& shift_m : shifts_m) about_m.push_back((shift_m - audit.median_shift_en_m).norm());
  audit.about_median_m = spread_of(about_m);
  if (audit.compared < options.min_compared) return;
  if (!(audit.registration.fit.left_out_m.median <= options.max_shift_m)) return;  // measured no better than that
  audit.verdict = audit.shift_m.quantile_95 <= options.max_shift_m ? AuditVerdict::kWithin : AuditVerdict::kBeyond;
}

}  // namespace

MapAudit audit_map(const std::string& map, const std::vector<std::string>& other, const AuditOptions& options,
                   int threads, const Progress& progress) {
  check_options(options);
  if (other.empty()) throw UsageError("an audit needs another map");
  const ImageryInfo of_this = inspect_imagery(map, options.imagery, progress);
  const auto other_infos = inspect_all(other, second_date_options(options.imagery), progress);
  MapAudit audit;
  audit.crs = audit_crs(options, of_this).crs;
  const Bounds of_map = imagery_bounds(of_this, audit.crs);
  const Bounds of_other = imagery_bounds(other_infos, audit.crs);
  audit.area_m = {std::max(of_map.min_x_m, of_other.min_x_m), std::max(of_map.min_y_m, of_other.min_y_m),
                  std::min(of_map.max_x_m, of_other.max_x_m), std::min(of_map.max_y_m, of_other.max_y_m)};
  if (audit.area_m.empty() || !of_map.intersects(of_other)) {
    throw DataError(other.front() + ": shows no ground that " + map + " shows");
  }
  std::vector<ImageryInfo> infos = other_infos;
  infos.insert(infos.begin(), of_this);
  for (const ImageryInfo& info : infos) {
    audit.warnings.insert(audit.warnings.end(), info.warnings.begin(), info.warnings.end());
  }
  const CommonGround common = common_ground(map, other, options.imagery, audit.crs, audit.area_m);
  if (cv::countNonZero(common.both) == 0) throw DataError(other.front() + ": shows no ground that " + map + " shows");
  const double gsd_m = registration_gsd_m(infos, options.registration);
  audit.registration.gsd_m = gsd_m;
  if (!square_fits(audit, options.registration.ties)) {
    audit.registration.fit = fit_warp({}, gsd_m, options.registration.warp);
  } else {
    audit.registration = register_dates(open_rasters({map}, options.imagery, other, audit.crs), audit.area_m, gsd_m,
                                        options.registration, {}, threads, progress);
  }
  judge(common, options, audit);
  audit.map_sigma_m = said_sigma_m({of_this}, audit.crs, common, audit.warnings);
  audit.other_sigma_m = said_sigma_m(other_infos, audit.crs, common, audit.warnings);
  return audit;
}

std::string why_not_known(const MapAudit& audit, const AuditOptions& options) {
  if (audit.verdict != AuditVerdict::kNotKnown) return "";
  if (audit.compared_m2 > 0 && audit.compared >= options.min_compared) {
    return "ties that were left out miss by " + format_fixed(audit.registration.fit.left_out_m.median, 2) +
           " m, more than " + format_number(options.max_shift_m) + " m (--max-shift-m)";
  }
  if (!square_fits(audit, options.registration.ties)) {
    return "the ground that both may show, " + format_fixed(audit.area_m.width_m(), 0) + " x " +
           format_fixed(audit.area_m.height_m(), 0) + " m, is too small for the square that is compared, " +
           std::to_string(options.registration.ties.template_px) + " pixels of " +
           format_number(audit.registration.gsd_m) + " m (--registration-ties-template-px, --registration-gsd-m)";
  }
  return percent_text(audit.compared) + " of the ground that both show could be compared, of the " +
         percent_text(options.min_compared) + " asked for (--min-compared); shifts are looked for up to " +
         format_number(options.registration.search_radius_m) + " m (--registration-search-radius-m)";
}

}  // namespace pilotage
