#include "pilotage/capture/map_grid.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "pilotage/base/angle.h"
#include "pilotage/base/error.h"
#include "pilotage/base/statistics.h"
#include "pilotage/base/text.h"

namespace pilotage {
namespace {

/// Of the map, at most: 0.3 m pixels over 30 km.
constexpr double kLargestSide_px = 100'000;

/// Two digits, so that it can be typed.
double rounded_gsd_m(double gsd_m) {
  const double scale = std::pow(10.0, 1 - std::floor(std::log10(gsd_m)));
  return std::round(gsd_m * scale) / scale;
}

}  // namespace

double map_gsd_m(const CaptureOptions& options, double frame_gsd_m) {
  constexpr double kCoarsestFactor = 2;  // bilinear looks at no more pixels than that
  if (options.gsd_m && *options.gsd_m > kCoarsestFactor * frame_gsd_m) {
    throw UsageError("gsd_m = " + format_number(*options.gsd_m) + " is more than twice that of the frames, " +
                     format_number(rounded_gsd_m(frame_gsd_m)) + " m; coarser levels are in the map (overviews)");
  }
  return options.gsd_m.value_or(rounded_gsd_m(frame_gsd_m));
}

void check_map_options(const CaptureOptions& options) {
  if (!options.crs.empty()) Crs::from_user_input(options.crs);
  if (options.align.empty() && options.align_sigma_m) throw UsageError("align_sigma_m needs align");
  refuse_imagery_as_elevation(options.elevation, {});
}

EastNorthBounds shown_bounds(const AdjustedBlock& block) {
  std::vector<double> heights_m;
  for (const AdjustedPoint& point : block.points) heights_m.push_back(point.enu_m.z());
  const double ground_m = quantile(heights_m, 0.5);
  EastNorthBounds bounds;
  bounds.low.setConstant(std::numeric_limits<double>::infinity());
  bounds.high = -bounds.low;
  const Lens lens = make_lens(block.camera);
  for (const FramePose& pose : block.poses) {
    const View view{lens, pose.enu_from_camera, std::max(0.1, pose.center_enu_m.z() - ground_m),
                    std::tan(60 * kRadPerDeg)};
    for (const Eigen::Vector2d& corner : footprint(view).polygon_m) {
      bounds.low = bounds.low.cwiseMin(pose.center_enu_m.head<2>() + corner);
      bounds.high = bounds.high.cwiseMax(pose.center_enu_m.head<2>() + corner);
    }
  }
  return bounds;
}

MissionCrs map_crs(const CaptureOptions& options, const LocalFrame& local, const EastNorthBounds& bounds) {
  const Eigen::Vector2d middle = (bounds.low + bounds.high) / 2;
  const std::vector<GeodeticPoint> line{point_at(local, {bounds.low.x(), middle.y()}),
                                        point_at(local, {bounds.high.x(), middle.y()})};
  const double half_m = std::max(1.0, (bounds.high.y() - bounds.low.y()) / 2);
  if (options.crs.empty()) return choose_mission_crs(line, half_m);
  return check_mission_crs(Crs::from_user_input(options.crs), line, half_m);
}

void place_grid(OrthoMosaic& mosaic, const EastNorthBounds& bounds) {
  const CrsTransform transform(mosaic.crs);
  Eigen::Vector2d low = Eigen::Vector2d::Constant(std::numeric_limits<double>::infinity());
  Eigen::Vector2d high = -low;
  constexpr int kSteps = 8;
  for (int i = 0; i <= kSteps; ++i) {
    for (int j = 0; j <= kSteps; ++j) {
      const Eigen::Vector2d share(static_cast<double>(i) / kSteps, static_cast<double>(j) / kSteps);
      const Eigen::Vector2d en_m = bounds.low + share.cwiseProduct(bounds.high - bounds.low);
      const auto point = transform.map_from_geodetic(point_at(mosaic.frame, en_m));
      if (!point) throw DataError("the map's CRS does not reach where the frames lie");
      low = low.cwiseMin(*point);
      high = high.cwiseMax(*point);
    }
  }
  const Eigen::Array2d first = (low.array() / mosaic.gsd_m).floor();
  const Eigen::Array2d last = (high.array() / mosaic.gsd_m).ceil();
  const Eigen::Array2d size = last - first;
  if (size.maxCoeff() > kLargestSide_px) {
    throw DataError("the map would be " + format_fixed(size.x(), 0) + " x " + format_fixed(size.y(), 0) +
                    " pixels (at most " + format_fixed(kLargestSide_px, 0) + " aside); give a larger --gsd-m");
  }
  mosaic.width_px = static_cast<std::int64_t>(size.x());
  mosaic.height_px = static_cast<std::int64_t>(size.y());
  mosaic.map_from_pixel = GeoTransform::north_up(first.x() * mosaic.gsd_m, last.y() * mosaic.gsd_m, mosaic.gsd_m);
}

double median_agl_m(const AdjustedBlock& block, const GroundSurface& ground) {
  std::vector<double> heights_m;
  for (const FramePose& pose : block.poses) {
    const double below_m = ground.heights.height_m(pose.center_enu_m.head<2>());
    if (std::isfinite(below_m)) heights_m.push_back(pose.center_enu_m.z() - below_m);
  }
  const double agl_m = quantile(heights_m, 0.5);
  if (!(agl_m > 0)) throw DataError("the frames come out below the ground: is the elevation model right?");
  return agl_m;
}

}  // namespace pilotage
