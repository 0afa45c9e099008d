#include "pilotage/capture/reference_ties.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

#include <opencv2/imgproc.hpp>

#include "pilotage/audit/audit_map.h"
#include "pilotage/base/error.h"
#include "pilotage/base/statistics.h"
#include "pilotage/base/text.h"
#include "pilotage/base/utf8.h"
#include "pilotage/camera/lens.h"
#include "pilotage/geo/position_covariance.h"
#include "pilotage/raster/map_sigma.h"
#include "pilotage/raster/mission_crs.h"

namespace pilotage {
namespace {

constexpr double kLeastSurfaceSigma_m = 0.1;
constexpr double kUnlikelySigmas = 3;
/// Ties that miss by so many times what was said of them are of a map that is bent.
constexpr double kBent = 1.5;
/// A registration's peak is good to this, in its pixels, where the pictures agree.
constexpr double kTieSigma_px = 0.5;
constexpr double kHair_m = 1e-6;
/// Frames are not reduced below this for the first map.
constexpr int kLeastSide_px = 64;
constexpr double kAnyShift_m = 1000;

/// Of the agreeing finest ties those of which no two look at the same ground: in their order, each that is a square
/// away from all before it.
std::vector<std::size_t> ties_apart(const MapAudit& audit, double side_m) {
  std::map<std::pair<int, int>, std::vector<std::size_t>> kept;  // by row and column of squares
  std::vector<std::size_t> numbers;
  for (const std::size_t number : agreeing_finest_ties(audit.registration)) {
    const Eigen::Vector2d& point_m = audit.registration.ties[number].point_m;
    const auto column = static_cast<int>(std::floor((point_m.x() - audit.area_m.min_x_m) / side_m));
    const auto row = static_cast<int>(std::floor((point_m.y() - audit.area_m.min_y_m) / side_m));
    bool apart = true;
    for (int y = row - 1; y <= row + 1; ++y) {
      for (int x = column - 1; x <= column + 1; ++x) {
        const auto found = kept.find({y, x});
        if (found == kept.end()) continue;
        for (const std::size_t other : found->second) {
          const Eigen::Vector2d away_m = audit.registration.ties[other].point_m - point_m;
          apart = apart && away_m.cwiseAbs().maxCoeff() > side_m - kHair_m;
        }
      }
    }
    if (!apart) continue;
    kept[{row, column}].push_back(number);
    numbers.push_back(number);
  }
  return numbers;
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
  for (const std::size_t number : ties_apart(audit, ties.template_px * registration.gsd_m)) {
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
    // A plane moves with the block; an elevation model stays where it is, and the ground is where the other map has it.
    double height_m = tie.enu_m.z();
    if (block.plane) {
      tie.above_plane_m = height_m - block.plane->dot(Eigen::Vector3d(tie.enu_m.x(), tie.enu_m.y(), 1));
    } else {
      height_m = mosaic.ground->heights.height_m(tie.reference_en_m);
    }
    tie.frame = static_cast<int>(*frame);
    const FramePose& pose = block.poses[*frame];
    const auto pixel = pixel_from_ray(lens, pose.enu_from_camera.transpose() * (tie.enu_m - pose.center_enu_m));
    if (!pixel || !std::isfinite(height_m)) continue;
    tie.pixel = *pixel;
    tie.enu_m.z() = height_m;
    found.push_back(tie);
  }
  return found;
}

/// The same map of pictures reduced by a whole factor, as coarse as `most_gsd_m` at most.
OrthoMosaic reduced(const OrthoMosaic& mosaic, double most_gsd_m, AdjustedBlock& block) {
  block = *mosaic.block;
  const int most = std::min(block.camera.width_px, block.camera.height_px) / kLeastSide_px;
  const int factor = std::max(1, std::min(most, static_cast<int>(most_gsd_m / mosaic.gsd_m)));
  block.camera = resized_camera(block.camera, block.camera.width_px / factor, block.camera.height_px / factor);
  block.reprojection_rms_px /= factor;
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
  audit.max_shift_m = kAnyShift_m;  // what ties miss is in their standard deviation
  audit.crs = options.crs;
  audit.registration = options.registration;
  return audit;
}

/// A map that is tied to another one says that it lies as well as that one: not where positions speak against it.
void refuse_contradiction(const MapAlignment& alignment, const MosaicStats& drawn) {
  const std::vector<double> sigmas_m = known_values(drawn.map_sigma_m);
  if (sigmas_m.empty()) return;
  const double apart_m = alignment.before.median_shift_en_m.norm();
  const double expected_m = std::hypot(quantile(sigmas_m, 0.5), alignment.reference_sigma_m);
  if (apart_m <= kUnlikelySigmas * expected_m) return;
  throw DataError(alignment.reference + ": lies " + format_fixed(apart_m, 1) +
                  " m from where the frames by themselves put the map, " + format_fixed(apart_m / expected_m, 1) +
                  " times what both may be off on each axis (" + format_fixed(expected_m, 1) +
                  " m): one of them is wrong, or not as good as is said (--align-sigma-m, --position-bias-sigma-m)");
}

/// What the other map may miss alike, each axis: as given; else as it says itself, or 1 m, with how its ground control
/// points and datum place it.
void take_reference_sigma(const CaptureOptions& options, const ImageryInfo& info, MapAlignment& alignment) {
  if (options.align_sigma_m) {
    alignment.reference_sigma_m = *options.align_sigma_m;
    alignment.sigma_source = ReferenceSigma::kGiven;
    return;
  }
  double sigma_m = kUnknownMapSigma_m;
  alignment.sigma_source = ReferenceSigma::kTaken;
  if (!info.map_sigma.empty()) {
    sigma_m = alignment.before.other_sigma_m;
    alignment.sigma_source = ReferenceSigma::kSaid;
    if (!(sigma_m > 0)) {
      throw DataError(options.align + ": what it says of its own error cannot be used here; give --align-sigma-m");
    }
  }
  alignment.reference_sigma_m = std::hypot(sigma_m, placement_rms_m(info) / std::numbers::sqrt2);
}

/// Messages and warnings name the map by where it is while it is not finished.
std::string without_path(std::string text, const std::string& path) {
  for (std::size_t at = text.find(path); at != std::string::npos; at = text.find(path)) {
    text.replace(at, path.size(), "the map of the frames");
  }
  return text;
}

}  // namespace

ImageryInfo inspect_reference(const CaptureOptions& options, const std::vector<GeodeticPoint>& frames,
                              const Progress& progress) {
  const ImageryInfo info = inspect_imagery(options.align, second_date_options({}), progress);
  if (!options.align_sigma_m && !info.map_sigma.empty() && !map_sigma_exists(info.map_sigma)) {
    throw DataError(options.align + ": says that its own error stands in " + name_as_utf8(info.map_sigma) +
                    ", which does not exist; put it there, or give --align-sigma-m");
  }
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
  return info;
}

MapAlignment tie_to_reference(const OrthoMosaic& mosaic, const CaptureOptions& options, const ImageryInfo& reference,
                              const OutputFile& output, int threads, const Progress& progress, Block& block) {
  AdjustedBlock reduced_block;
  const OrthoMosaic draft = reduced(mosaic, registration_gsd_m({reference}, options.registration) / 2, reduced_block);
  const OutputFile file(output.temporary_path().parent_path() / "draft.tif", true);
  const MosaicStats drawn = write_mosaic(file, draft, {}, threads, progress);
  MapAlignment alignment;
  alignment.reference = options.align;
  alignment.before = audit_against_reference(file, options, threads, progress);
  if (alignment.before.verdict == AuditVerdict::kNotKnown) {
    throw DataError(options.align + ": the map of the frames cannot be tied to it: " +
                    why_not_known(alignment.before, audit_options(options)));
  }
  take_reference_sigma(options, reference, alignment);
  refuse_contradiction(alignment, drawn);
  block.reference_ties = reference_ties(alignment.before, options.registration.ties, *mosaic.block, draft, drawn);
  if (block.reference_ties.empty()) throw DataError(options.align + ": no tie to it lies on ground that a frame shows");
  alignment.ties = static_cast<int>(block.reference_ties.size());
  block.reference_sigma_m = alignment.counted_sigma_m = alignment.reference_sigma_m;
  block.surface_sigma_m = std::max(kLeastSurfaceSigma_m, mosaic.ground->spread_m);
  return alignment;
}

bool loosen_ties(const AdjustedBlock& adjusted, MapAlignment& alignment, Block& block) {
  alignment.tie_rms_m = quantile(adjusted.tie_misses_m, 0.5) / kMedianOfLengths;
  const double said_m = block.reference_ties.front().sigma_m;
  if (!(alignment.tie_rms_m > kBent * said_m)) return false;
  for (ReferenceTie& tie : block.reference_ties) tie.sigma_m = alignment.tie_rms_m;
  block.reference_sigma_m = alignment.counted_sigma_m = std::hypot(alignment.reference_sigma_m, alignment.tie_rms_m);
  return true;
}

MapAudit audit_against_reference(const OutputFile& output, const CaptureOptions& options, int threads,
                                 const Progress& progress) {
  const std::string path = output.temporary_path().string();
  try {
    MapAudit audit = audit_map(path, {options.align}, audit_options(options), threads, progress);
    std::erase_if(audit.warnings, [&](const std::string& text) { return text.find(path) != std::string::npos; });
    return audit;
  } catch (const DataError& error) {
    throw DataError(without_path(error.what(), path));
  }
}

}  // namespace pilotage
