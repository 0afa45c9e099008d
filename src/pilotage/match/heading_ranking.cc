#include "pilotage/match/heading_ranking.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>

#include <Eigen/Geometry>
#include <opencv2/imgproc.hpp>

#include "pilotage/base/angle.h"
#include "pilotage/geo/bounds.h"
#include "pilotage/match/displacement_voting.h"
#include "pilotage/match/frame_on_grid.h"
#include "pilotage/match/local_map.h"
#include "pilotage/match/relief.h"
#include "pilotage/match/search_memory.h"

namespace pilotage {
namespace {

/// How far the highest bin stands above the others, in standard deviations of votes of chance; 0 without votes.
double height_of_peak(const std::vector<double>& bins) {
  const double mean = std::accumulate(bins.begin(), bins.end(), 0.0) / static_cast<double>(bins.size());
  if (!(mean > 0)) return 0;
  return (*std::max_element(bins.begin(), bins.end()) - mean) / std::sqrt(mean);
}

/// The votes of all pairs for places of the pivot in the square, under one turn and scale 1; each is shared by the four
/// bins about it.
std::vector<double> coarse_bins(const std::vector<VotePair>& pairs, const SearchSpace& space, double turn_rad) {
  const double side_px = 2 * space.half_width_px;
  const auto side = static_cast<std::size_t>(side_px / kCoarseBinPx) + 2;
  const Eigen::Rotation2Dd turn(turn_rad);
  const Eigen::Vector2d corner_px = space.center_px - Eigen::Vector2d::Constant(space.half_width_px);
  std::vector<double> bins(side * side, 0.0);
  for (const VotePair& pair : pairs) {
    const Eigen::Vector2d at_px = pair.map_px - turn * pair.from_pivot_px - corner_px;
    if (at_px.minCoeff() < 0 || at_px.maxCoeff() >= side_px) continue;
    const Eigen::Vector2d at = at_px / kCoarseBinPx;
    const auto column = static_cast<std::size_t>(at.x());
    const auto row = static_cast<std::size_t>(at.y());
    const double right = at.x() - static_cast<double>(column);
    const double down = at.y() - static_cast<double>(row);
    const double votes = pair.weight / kVoteUnit;
    double* const bin = &bins[row * side + column];
    bin[0] += votes * (1 - right) * (1 - down);
    bin[1] += votes * right * (1 - down);
    bin[side] += votes * (1 - right) * down;
    bin[side + 1] += votes * right * down;
  }
  return bins;
}

/// So that kCoarsePoints of a frame are described, as far as the limits let it.
int coarse_step_px(const FrameOnGrid& rectified) {
  const double valid_px = cv::countNonZero(rectified.frame.valid);
  return std::clamp(static_cast<int>(std::sqrt(valid_px / kCoarsePoints)), kFinestCoarseStepPx, kCoarsestStepPx);
}

/// Of how many features of the map one votes, so that kCoarseVoters are left under the frame.
std::size_t coarse_stride(const PivotedFrame& frame, const LocalMap& local, double window_px) {
  const double frame_px = static_cast<double>(frame.grid.points.size()) * frame.grid.step_px * frame.grid.step_px;
  const double under_frame = static_cast<double>(local.features.size()) * frame_px / (4 * window_px * window_px);
  return static_cast<std::size_t>(std::max(1.0, std::floor(under_frame / kCoarseVoters)));
}

/// The features that any heading may show, read once.
struct CoarseMap {
  LocalMap local;
  double window_px = 0;  ///< Half the side of the square about the prior's place that was read.
};

std::optional<CoarseMap> read_coarse_map(const cv::Mat& frame, const MatchPrior& prior, MapReader& map,
                                         const MatchOptions& options, const FrameOnGrid& rectified,
                                         const PivotedFrame& described, const Checkpoint& checkpoint) {
  const FeatureOptions& features = map.features();
  constexpr double kMostGrowth = 2;  // of a frame's pixels, by a turn of 45°
  const double left_bytes =
      options.max_memory_mib * kMib - bytes_to_rectify(frame) - kMostGrowth * bytes_to_describe(rectified, features);
  const double most = std::min(std::max(0.0, left_bytes) / bytes_of_map_feature(features), 1e9);
  CoarseMap coarse;
  coarse.window_px = rectified.half_width_px + rectified.px_from_m(rectified.pivot_m).norm() + described.radius_px;
  coarse.local = read_local_map(map, *rectified.level, rectified.grid, rectified.prior_px, coarse.window_px,
                                static_cast<std::size_t>(most), checkpoint);
  const bool is_readable = coarse.local.features.descriptor_bytes * 8 == features.descriptor_bits;
  if (coarse.local.features.size() == 0 || static_cast<double>(coarse.local.features.size()) > most || !is_readable) {
    return std::nullopt;
  }
  coarse.local.relief = relief_of(coarse.local, {}, {},
                                  {rectified.prior_px - coarse.local.reference_px,
                                   largest_sigma_m(prior.covariance_en_m2) / rectified.gsd_m, prior.height_agl_m});
  return coarse;
}

/// What the look says for the heading of a frame: 0 where there is no map.
double promise_of_heading(const FrameOnGrid& rectified, const cv::Mat& frame, const MatchPrior& prior, MapReader& map,
                          const MatchOptions& options, std::optional<CoarseMap>& coarse, const Checkpoint& checkpoint) {
  const PivotedFrame described = pivoted_frame(
      rectified, describe_continued_grid(rectified.frame, map.features(), coarse_step_px(rectified), checkpoint));
  if (!coarse) coarse = read_coarse_map(frame, prior, map, options, rectified, described, checkpoint);
  if (!coarse) return 0;
  const SearchSpace space = search_space(rectified, coarse->local, options);
  const std::vector<VotePair> pairs = vote_pairs(described, coarse->local, space, checkpoint,
                                                 coarse_stride(described, coarse->local, coarse->window_px));
  double promise = 0;
  for (const int side : {-1, 0, 1}) {  // three thirds of what two sigma of yaw reach
    const double turn_rad = side * 2 * space.yaw_sigma_rad * 2 / 3;
    promise = std::max(promise, height_of_peak(coarse_bins(pairs, space, turn_rad)));
  }
  return promise;
}

}  // namespace

FrameOnGrid turned_frame(const FrameOnGrid& rectified, double turn_rad) {
  if (turn_rad == 0) return rectified;
  const RectifiedFrame& as_is = rectified.frame;
  const Eigen::Rotation2Dd turn(-turn_rad);  // of east and north
  const double gsd_m = as_is.gsd_m;
  Bounds bounds;
  for (const int right : {0, as_is.gray.cols}) {
    for (const int down : {0, as_is.gray.rows}) bounds.extend(turn * as_is.ground_from_pixel({right, down}));
  }
  FrameOnGrid turned = rectified;
  turned.pivot_m = turn * rectified.pivot_m;
  turned.frame.origin_m = {std::floor(bounds.min_x_m / gsd_m) * gsd_m, std::ceil(bounds.max_y_m / gsd_m) * gsd_m};
  const Eigen::Vector2d corner_px = turned.frame.pixel_from_ground({bounds.max_x_m, bounds.min_y_m});
  const cv::Size size(static_cast<int>(std::ceil(corner_px.x())), static_cast<int>(std::ceil(corner_px.y())));
  // Of the middles of three pixels, in OpenCV's positions: the first pixel's middle is 0.
  std::array<cv::Point2f, 3> to;
  std::array<cv::Point2f, 3> from;
  const std::array<Eigen::Vector2d, 3> middles{Eigen::Vector2d(0.5, 0.5), Eigen::Vector2d(size.width - 0.5, 0.5),
                                               Eigen::Vector2d(0.5, size.height - 0.5)};
  for (std::size_t i = 0; i < middles.size(); ++i) {
    const Eigen::Vector2d there = as_is.pixel_from_ground(turn.inverse() * turned.frame.ground_from_pixel(middles[i]));
    to[i] = {static_cast<float>(middles[i].x() - 0.5), static_cast<float>(middles[i].y() - 0.5)};
    from[i] = {static_cast<float>(there.x() - 0.5), static_cast<float>(there.y() - 0.5)};
  }
  const cv::Mat as_is_from_turned = cv::getAffineTransform(to.data(), from.data());
  turned.frame.gray = turned.frame.valid = cv::Mat();  // not those of `rectified`
  constexpr int kHow = cv::INTER_LINEAR | cv::WARP_INVERSE_MAP;
  cv::warpAffine(as_is.gray, turned.frame.gray, as_is_from_turned, size, kHow, cv::BORDER_REPLICATE);
  cv::warpAffine(as_is.valid, turned.frame.valid, as_is_from_turned, size, kHow, cv::BORDER_CONSTANT);
  turned.frame.valid = turned.frame.valid == 255;
  return turned;
}

std::vector<double> promising_headings_deg(const cv::Mat& frame, const MatchPrior& prior, const Camera& camera,
                                           MapReader& map, const MatchOptions& options,
                                           const std::vector<double>& headings_deg, std::size_t count,
                                           const Checkpoint& checkpoint) {
  if (headings_deg.empty()) return {};
  std::optional<CoarseMap> coarse;
  MatchPrior first = prior;
  first.attitude.yaw_deg = headings_deg.front();
  FrameOnGrid rectified = rectify_frame(frame, first, camera, map, options, checkpoint);
  if (!rectified.refusal) rectified.frame = continued_frame(rectified.frame, map.features());
  std::vector<double> promises;
  for (const double heading_deg : headings_deg) {
    const double turn_rad = (heading_deg - headings_deg.front()) * kRadPerDeg;
    promises.push_back(rectified.refusal ? 0
                                         : promise_of_heading(turned_frame(rectified, turn_rad), frame, prior, map,
                                                              options, coarse, checkpoint));
  }
  std::vector<std::size_t> order(headings_deg.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return promises[a] > promises[b]; });
  order.resize(std::min(order.size(), count));
  std::vector<double> promising_deg;
  for (const std::size_t index : order) promising_deg.push_back(headings_deg[index]);
  return promising_deg;
}

}  // namespace pilotage
