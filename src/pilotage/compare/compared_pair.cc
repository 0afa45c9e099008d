#include "pilotage/compare/compared_pair.h"

#include <cmath>

#include <opencv2/imgproc.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/text.h"
#include "pilotage/geo/bounds.h"
#include "pilotage/raster/gdal_io.h"
#include "pilotage/raster/gray_stretch.h"

namespace pilotage {
namespace {

constexpr double kMaxOffNadirDeg = 65;
constexpr int kMaxFramePx = 8192;

Crs local_crs(GeodeticPoint center) {
  return Crs::from_user_input("+proj=aeqd +lat_0=" + format_number(center.lat_deg) +
                              " +lon_0=" + format_number(center.lon_deg) + " +datum=WGS84 +units=m +no_defs +type=crs");
}

void check_record(const FrameRecord& record) {
  const auto refuse = [&](const std::string& what) { throw DataError(record.file + ": " + what); };
  if (!record.truth()) refuse("a comparison needs true_lon_deg and true_lat_deg of every frame");
  const Attitude& a = record.attitude;
  if (!std::isfinite(a.yaw_deg) || !std::isfinite(a.pitch_deg) || !std::isfinite(a.roll_deg)) {
    refuse("yaw_deg, pitch_deg and roll_deg must be known");
  }
  if (!record.prior_covariance_en_m2.allFinite()) refuse("prior_sigma_m must be known");
}

// Features keep away from where the imagery ends: that edge is not on the ground.
cv::Mat allowed_within(const cv::Mat& valid) {
  cv::Mat allowed;
  const int side = 2 * kEdgeMarginPx + 1;
  cv::erode(valid, allowed, cv::getStructuringElement(cv::MORPH_RECT, {side, side}));
  return allowed;
}

void fill_with_mean(cv::Mat& gray, const cv::Mat& valid) {
  gray.setTo(cv::mean(gray, valid), valid == 0);
}

/// The point that the pair is compared at: the wanted one, or the other where only that is known.
FrameTruth anchor_kind(const FrameRecord& record, FrameTruth wanted) {
  const bool center = wanted == FrameTruth::kCenter ? record.true_center.has_value() : !record.true_nadir;
  return center ? FrameTruth::kCenter : FrameTruth::kNadir;
}

struct Anchor {
  Eigen::Vector2d ground_m;
  Eigen::Vector2d frame_px;
};

std::optional<Anchor> find_anchor(const View& view, const Camera& camera, FrameTruth truth) {
  if (truth == FrameTruth::kCenter) {
    const Eigen::Vector2d principal_point(camera.cx_px, camera.cy_px);
    const auto ground = ground_from_pixel(view, principal_point);
    if (!ground) return std::nullopt;
    return Anchor{*ground, principal_point};
  }
  const auto pixel = pixel_from_ground(view, {0, 0});
  if (!pixel) return std::nullopt;
  return Anchor{{0, 0}, *pixel};
}

// The reference around `wanted` (ground), and where the truth lies on it.
void read_reference(const std::vector<std::string>& datasets, const FrameRecord& record, const Bounds& wanted,
                    const CompareOptions& options, ComparedPair& pair) {
  const double width = std::ceil(wanted.width_m() / pair.gsd_m);
  const double height = std::ceil(wanted.height_m() / pair.gsd_m);
  if (!(width <= kMaxReferencePx && height <= kMaxReferencePx)) {
    throw DataError(record.file + ": the reference around its prior would have " + format_number(width) + " x " +
                    format_number(height) + " px, allowed are " + std::to_string(kMaxReferencePx) +
                    "; a coarser gsd_m, or fewer search_sigmas");
  }
  const Crs crs = local_crs(record.prior);
  pair.reference_corner_m = {wanted.min_x_m, wanted.max_y_m};
  const GeoTransform grid = GeoTransform::north_up(wanted.min_x_m, wanted.max_y_m, pair.gsd_m);
  const GraySource source = stretch_to_8bit(open_gray_on_grid(datasets, crs, grid, static_cast<std::int64_t>(width),
                                                              static_cast<std::int64_t>(height), options.imagery));
  Raster raster = source.read({0, 0, static_cast<int>(width), static_cast<int>(height)});
  pair.reference = raster.pixels.clone();
  fill_with_mean(pair.reference, raster.valid);
  pair.reference_allowed = allowed_within(raster.valid);

  const bool at_center = anchor_kind(record, options.truth) == FrameTruth::kCenter;
  const std::optional<Eigen::Vector2d> truth =
      CrsTransform(crs).map_from_geodetic(at_center ? *record.true_center : *record.true_nadir);
  if (!truth) throw DataError(record.file + ": its true position is on the other side of the Earth from its prior");
  pair.true_anchor_m = *truth;
  const Eigen::Vector2d pixel = pair.reference_from_ground(pair.true_anchor_m);
  const bool within = (pair.true_anchor_m - pair.anchor_m).cwiseAbs().maxCoeff() <= pair.search_m;
  pair.shows_reference = within && pixel.x() >= 0 && pixel.y() >= 0 && pixel.x() < width && pixel.y() < height &&
                         raster.valid.at<std::uint8_t>(static_cast<int>(pixel.y()), static_cast<int>(pixel.x())) != 0;
}

}  // namespace

Eigen::Vector2d ComparedPair::reference_from_ground(const Eigen::Vector2d& ground_m) const {
  const Eigen::Vector2d offset = ground_m - reference_corner_m;
  return {offset.x() / gsd_m, -offset.y() / gsd_m};
}

Eigen::Vector2d ComparedPair::ground_from_reference(const Eigen::Vector2d& pixel) const {
  return reference_corner_m + Eigen::Vector2d(pixel.x() * gsd_m, -pixel.y() * gsd_m);
}

std::optional<Eigen::Vector2d> ComparedPair::true_ground(const Eigen::Vector2d& frame_px) const {
  std::optional<Eigen::Vector2d> ground;
  if (const auto* rectified = std::get_if<RectifiedFrame>(&geometry)) {
    ground = rectified->ground_from_pixel(frame_px);
  } else {
    ground = ground_from_pixel(std::get<View>(geometry), frame_px);
  }
  if (!ground) return std::nullopt;
  return true_anchor_m + (*ground - anchor_m);
}

PairOrProblem make_compared_pair(const std::vector<std::string>& reference, const FrameRecord& record,
                                 const cv::Mat& frame, const Camera& camera, double gsd_m,
                                 const CompareOptions& options) {
  check_record(record);
  const RectifyOptions rectify{gsd_m, kMaxFramePx, kMaxOffNadirDeg};
  RectifiedFrame rectified = ortho_rectify(frame, camera, record.attitude, record.height_agl_m, rectify);
  if (rectified.status != RectifyStatus::kOk) return std::string(rectify_status_text(rectified.status));
  const std::optional<View> view = make_view(camera, record.attitude, record.height_agl_m, kMaxOffNadirDeg);
  const std::optional<Anchor> anchor =
      view ? find_anchor(*view, camera, anchor_kind(record, options.truth)) : std::nullopt;
  if (!anchor) return std::string("The point of which the truth is known lies above the horizon.");

  ComparedPair pair;
  pair.gsd_m = gsd_m;
  pair.search_m = options.search_sigmas * largest_sigma_m(record.prior_covariance_en_m2);
  pair.anchor_m = anchor->ground_m;
  const Footprint ground = footprint(*view);
  Bounds wanted;
  for (const Eigen::Vector2d& corner : ground.polygon_m) wanted.extend(corner);
  if (options.raw) {
    pair.frame = frame;
    pair.frame_allowed = cv::Mat(frame.size(), CV_8UC1, cv::Scalar(255));
    pair.frame_area_m2 = ground.area_m2;
    const GroundSampleDistance of_frame = pilotage::gsd_m(camera, record.height_agl_m);
    pair.expected_scale = (of_frame.across_m + of_frame.along_m) / 2 / gsd_m;
    pair.anchor_px = anchor->frame_px;
    pair.geometry = *view;
  } else {
    pair.frame = rectified.gray;
    fill_with_mean(pair.frame, rectified.valid);
    pair.frame_allowed = allowed_within(rectified.valid);
    pair.frame_area_m2 = cv::countNonZero(pair.frame_allowed) * gsd_m * gsd_m;
    pair.anchor_px = rectified.pixel_from_ground(anchor->ground_m);
    rectified.gray.release();
    rectified.valid.release();
    pair.geometry = std::move(rectified);
  }
  read_reference(reference, record, wanted.grown(pair.search_m), options, pair);
  return pair;
}

}  // namespace pilotage
