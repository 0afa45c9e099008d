#include "pilotage/capture/reference_ties.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include <opencv2/imgproc.hpp>

#include "pilotage/audit/audit_map.h"
#include "pilotage/base/error.h"
#include "pilotage/base/statistics.h"
#include "pilotage/base/text.h"
#include "pilotage/camera/lens.h"
#include "pilotage/raster/mission_crs.h"

namespace pilotage {
namespace {

/// Of the other map, where nobody says how good it is.
constexpr double kReferenceSigma_m = 1;
constexpr double kLeastSurfaceSigma_m = 0.1;
constexpr double kUnlikelySigmas = 3;
/// A registration's peak is good to this, in its pixels, where the pictures agree.
constexpr double kTieSigma_px = 0.5;
/// The median of the lengths of errors normal in two axes, over the standard deviation of one.
constexpr double kMedianOfLengths = 1.1774;

/// The tie nearest the middle of each square of `side_m`, by row and column of squares.
std::map<std::pair<int, int>, std::size_t> one_of_each_square(const MapAudit& audit, double side_m) {
  std::map<std::pair<int, int>, std::size_t> nearest;
  const auto from_middle = [&](std::size_t number) {
    const Eigen::Array2d squares =
        (audit.registration.ties[number].point_m.array() - Eigen::Array2d(audit.area_m.min_x_m, audit.area_m.min_y_m)) /
        side_m;
    return std::pair<Eigen::Array2d, double>(squares.floor(), (squares - squares.floor() - 0.5).matrix().norm());
  };
  for (const std::size_t number : agreeing_finest_ties(audit.registration)) {
    const auto [square, distance] = from_middle(number);
    const std::pair<int, int> place(static_cast<int>(square.y()), static_cast<int>(square.x()));
    const auto [found, is_new] = nearest.try_emplace(place, number);
    if (!is_new && distance < from_middle(found->second).second) found->second = number;
  }
  return nearest;
}

/// The frame of which the map shows most there, from 0.
std::optional<std::size_t> shown_frame(const OrthoMosaic& mosaic, const MosaicStats& drawn,
                                       const Eigen::Vector2d& map_m) {
  const Eigen::Array2d cell = (mosaic.map_from_pixel.pixel_from_map(map_m).array() / kMapCell_px).floor();
  if (!(cell >= 0).all() || cell.x() >= drawn.cell_frame.cols || cell.y() >= drawn.cell_frame.rows) return std::nullopt;
  const float number = drawn.cell_frame.at<float>(static_cast<int>(cell.y()), static_cast<int>(cell.x()));
  if (!(number >= 1)) return std::nullopt;
  return static_cast<std::size_t>(number) - 1;
}

/// `drawn` says which frame the first map (`mosaic`, at whatever resolution) shows where; pixels are `block`'s.
std::vector<ReferenceTie> reference_ties(const MapAudit& audit, const TieOptions& ties, const AdjustedBlock& block,
                                         const OrthoMosaic& mosaic, const MosaicStats& drawn) {
  const Registration& registration = audit.registration;
  const double sigma_m =
      std::max(kTieSigma_px * registration.gsd_m, registration.fit.left_out_m.median / kMedianOfLengths);
  const Lens lens = make_lens(block.camera);
  const CrsTransform of_audit(audit.crs);
  const CrsTransform of_map(mosaic.crs);
  std::vector<ReferenceTie> found;
  for (const auto& [square, number] : one_of_each_square(audit, ties.template_px * registration.gsd_m)) {
    const Tie& one = registration.ties[number];
    const auto here = of_audit.geodetic_from_map(one.point_m);
    const auto there = of_audit.geodetic_from_map(one.point_m + one.displacement_m);
    if (!here || !there) continue;
    const auto map_m = of_map.map_from_geodetic(*here);
    if (!map_m) continue;
    const auto frame = shown_frame(mosaic, drawn, *map_m);
    if (!frame) continue;
    ReferenceTie tie;
    tie.reference_en_m = east_north_m(mosaic.frame, *there);
    tie.sigma_m = sigma_m;
    tie.enu_m << east_north_m(mosaic.frame, *here), 0;
    tie.enu_m.z() = mosaic.ground->heights.height_m(tie.enu_m.head<2>());
    if (block.plane)
      tie.above_plane_m = tie.enu_m.z() - block.plane->dot(Eigen::Vector3d(tie.enu_m.x(), tie.enu_m.y(), 1));
    tie.frame = static_cast<int>(*frame);
    const FramePose& pose = block.poses[*frame];
    const auto pixel = pixel_from_ray(lens, pose.enu_from_camera.transpose() * (tie.enu_m - pose.center_enu_m));
    if (!pixel || !std::isfinite(tie.enu_m.z())) continue;
    tie.pixel = *pixel;
    found.push_back(tie);
  }
  return found;
}

/// The same map of pictures reduced by a whole factor, as coarse as `most_gsd_m` at most.
OrthoMosaic reduced(const OrthoMosaic& mosaic, double most_gsd_m, AdjustedBlock& block) {
  const int factor = std::max(1, static_cast<int>(most_gsd_m / mosaic.gsd_m));
  block = *mosaic.block;
  block.camera = resized_camera(block.camera, std::max(1, block.camera.width_px / factor),
                                std::max(1, block.camera.height_px / factor));
  OrthoMosaic small = mosaic;
  small.block = &block;
  small.load = [load = mosaic.load, size = cv::Size(block.camera.width_px, block.camera.height_px)](std::size_t frame) {
    cv::Mat picture;
    cv::resize(load(frame), picture, size, 0, 0, cv::INTER_AREA);
    return picture;
  };
  small.gsd_m = mosaic.gsd_m * factor;
  small.width_px = (mosaic.width_px + factor - 1) / factor;
  small.height_px = (mosaic.height_px + factor - 1) / factor;
  const Eigen::Vector2d corner_m = mosaic.map_from_pixel.map_from_pixel({0, 0});
  small.map_from_pixel = GeoTransform::north_up(corner_m.x(), corner_m.y(), small.gsd_m);
  return small;
}

AuditOptions audit_options(const CaptureOptions& options) {
  AuditOptions audit;
  audit.min_compared = options.min_compared;
  audit.crs = options.crs;
  audit.registration = options.registration;
  return audit;
}

/// audit_map(), whose messages name the map by where it is while it is not finished.
MapAudit audit_unfinished(const std::filesystem::path& map, const CaptureOptions& options, int threads,
                          const Progress& progress) try {
  return audit_map(map.string(), {options.align}, audit_options(options), threads, progress);
} catch (const DataError& error) {
  std::string message = error.what();
  for (std::size_t at = message.find(map.string()); at != std::string::npos; at = message.find(map.string())) {
    message.replace(at, map.string().size(), "the map of the frames");
  }
  throw DataError(message);
}

/// A map that is tied to another one says that it lies as well as that one: not where positions speak against it.
void refuse_contradiction(const MapAlignment& alignment, const MosaicStats& drawn) {
  std::vector<double> sigmas_m;
  for (const float sigma_m : cv::Mat_<float>(drawn.map_sigma_m)) {
    if (std::isfinite(sigma_m)) sigmas_m.push_back(static_cast<double>(sigma_m));
  }
  const double apart_m = alignment.before.median_shift_en_m.norm();
  const double expected_m = std::hypot(quantile(sigmas_m, 0.5), alignment.reference_sigma_m);
  if (apart_m <= kUnlikelySigmas * expected_m) return;
  throw DataError(alignment.reference + ": lies " + format_fixed(apart_m, 1) +
                  " m from where the frames by themselves put the map, " + format_fixed(apart_m / expected_m, 1) +
                  " times what both may be off on each axis (" + format_fixed(expected_m, 1) +
                  " m): one of them is wrong, or not as good as is said (--align-sigma-m, --position-bias-sigma-m)");
}

}  // namespace

void check_reference(const CaptureOptions& options, const std::vector<GeodeticPoint>& frames,
                     const Progress& progress) {
  const ImageryInfo info = inspect_imagery(options.align, second_date_options({}), progress);
  const Crs crs = choose_mission_crs(frames, options.registration.search_radius_m).crs;
  const CrsTransform transform(crs);
  Bounds seen_from;
  for (const GeodeticPoint& frame : frames) {
    if (const auto place_m = transform.map_from_geodetic(frame)) seen_from.extend(*place_m);
  }
  const Bounds shown = imagery_bounds(info, crs);
  if (shown.empty() || !shown.intersects(seen_from)) {
    throw DataError(options.align + ": shows no ground below the frames");
  }
}

MapAlignment tie_to_reference(const OrthoMosaic& mosaic, const CaptureOptions& options, const OutputFile& output,
                              int threads, const Progress& progress, Block& block) {
  const ImageryInfo info = inspect_imagery(options.align, second_date_options({}), progress);
  AdjustedBlock reduced_block;
  const OrthoMosaic draft = reduced(mosaic, registration_gsd_m({info}, options.registration) / 2, reduced_block);
  const OutputFile file(output.temporary_path().parent_path() / "draft.tif", true);
  const MosaicStats drawn = write_mosaic(file, draft, {}, threads, progress);
  MapAlignment alignment;
  alignment.reference = options.align;
  alignment.before = audit_unfinished(file.temporary_path(), options, threads, progress);
  if (alignment.before.verdict == AuditVerdict::kNotKnown) {
    throw DataError(options.align + ": the map of the frames cannot be tied to it: " +
                    why_not_known(alignment.before, audit_options(options)));
  }
  block.reference_ties = reference_ties(alignment.before, options.registration.ties, *mosaic.block, draft, drawn);
  if (block.reference_ties.empty()) throw DataError(options.align + ": no tie to it lies on ground that a frame shows");
  alignment.ties = static_cast<int>(block.reference_ties.size());
  if (options.align_sigma_m) {
    alignment.reference_sigma_m = *options.align_sigma_m;
    alignment.sigma_source = "given";
  } else if (!std::isnan(alignment.before.other_sigma_m)) {
    alignment.reference_sigma_m = std::max(1e-3, alignment.before.other_sigma_m);
    alignment.sigma_source = "as it says itself";
  } else {
    alignment.reference_sigma_m = kReferenceSigma_m;
    alignment.sigma_source = "taken for granted";
  }
  refuse_contradiction(alignment, drawn);
  block.reference_sigma_m = alignment.reference_sigma_m;
  block.surface_sigma_m = std::max(kLeastSurfaceSigma_m, mosaic.ground->spread_m);
  return alignment;
}

MapAudit audit_against_reference(const OutputFile& output, const CaptureOptions& options, int threads,
                                 const Progress& progress) {
  return audit_unfinished(output.temporary_path(), options, threads, progress);
}

}  // namespace pilotage
