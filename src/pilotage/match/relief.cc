#include "pilotage/match/relief.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "pilotage/match/local_map.h"

namespace pilotage {
namespace {

constexpr double kLeastStretch = 0.3;
constexpr double kMostStretch = 3;
constexpr double kMostReliefSigma = 0.25;  // two of them: down to half, where guided matching ends
/// Where the ground is asked for its height when a frame is laid over it, in pixels of the frame; linear between them.
constexpr int kNodePx = 16;

Eigen::Vector2d place_of(const Feature& feature) {
  return {static_cast<double>(feature.x_px), static_cast<double>(feature.y_px)};
}

/// Where heights are known, and what they are.
struct GroundPoints {
  std::vector<Eigen::Vector2d> places_px;
  std::vector<double> heights_m;

  void add(const Eigen::Vector2d& place_px, double height_m) {
    if (!std::isfinite(height_m)) return;
    places_px.push_back(place_px);
    heights_m.push_back(height_m);
  }

  void add(const LocalMap& map, const Eigen::Vector2d& shift_px) {
    for (std::size_t i = 0; i < map.features.size(); ++i) {
      add(place_of(map.features.features[i]) + shift_px, static_cast<double>(map.ground_height_m[i]));
    }
  }
};

/// How far points must lie apart to tell a slope: of features hardly at all; a few places in a row say nothing of what
/// lies beside them.
constexpr double kLevelFeatures_px = 1;
constexpr double kLevelSparse_px = 30;

/// Root mean square of the heights over `below_m`, weighted by how likely the aircraft is above them; where it is above
/// none of them, of all.
double height_spread_m(const GroundPoints& points, const PriorNadir& nadir, double below_m) {
  double weights = 0;
  double weighted_m2 = 0;
  double sum_m2 = 0;
  for (std::size_t i = 0; i < points.places_px.size(); ++i) {
    const double off = (points.places_px[i] - nadir.place_px).norm() / std::max(nadir.sigma_px, 1.0);
    const double weight = std::exp(-off * off / 2);
    const double rise_m = points.heights_m[i] - below_m;
    weights += weight;
    weighted_m2 += weight * rise_m * rise_m;
    sum_m2 += rise_m * rise_m;
  }
  constexpr double kOneFeature = 1;
  if (weights >= kOneFeature) return std::sqrt(weighted_m2 / weights);
  return std::sqrt(sum_m2 / static_cast<double>(points.places_px.size()));
}

/// The same of a ground that is known at few places: as it is taken to be, and what is not known of it.
double sparse_spread_m(const GroundHeights& ground, const PriorNadir& nadir, double below_m) {
  constexpr int kAround = 8;
  double sum_m2 = kSparseHeightSigma_m * kSparseHeightSigma_m;
  for (int i = 0; i < kAround; ++i) {
    const double angle = 2 * std::numbers::pi * i / kAround;
    const Eigen::Vector2d off_px = nadir.sigma_px * Eigen::Vector2d(std::cos(angle), std::sin(angle));
    sum_m2 += std::pow(ground.height_m(nadir.place_px + off_px) - below_m, 2) / kAround;
  }
  return std::sqrt(sum_m2);
}

/// For every pixel of a frame that lies on the ground, the pixel of the level frame that shows it: OpenCV's positions.
cv::Mat level_pixels(const RectifiedFrame& level, const Relief& relief, const Eigen::Vector2d& nadir_px,
                     double px_per_pixel) {
  const Eigen::Vector2d nadir = level.pixel_from_ground({0, 0});
  const int columns = level.gray.cols / kNodePx + 2;
  const int rows = level.gray.rows / kNodePx + 2;
  cv::Mat nodes(rows, columns, CV_32FC2);
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const Eigen::Vector2d off(column * kNodePx - nadir.x(), row * kNodePx - nadir.y());
      const Eigen::Vector2d shown = nadir + off / relief.stretch_at(nadir_px + px_per_pixel * off);
      nodes.at<cv::Vec2f>(row, column) = {static_cast<float>(shown.x() - 0.5), static_cast<float>(shown.y() - 0.5)};
    }
  }
  // Centres of pixels lie half a pixel behind the nodes that begin them.
  cv::Mat pixels;
  const cv::Matx23d node_from_pixel(1.0 / kNodePx, 0, 0.5 / kNodePx, 0, 1.0 / kNodePx, 0.5 / kNodePx);
  cv::warpAffine(nodes, pixels, node_from_pixel, level.gray.size(), cv::INTER_LINEAR | cv::WARP_INVERSE_MAP,
                 cv::BORDER_REPLICATE);
  return pixels;
}

}  // namespace

double Relief::stretch_of_height(double height_m) const {
  return std::clamp(1 - (height_m - below_m) / height_agl_m, kLeastStretch, kMostStretch);
}

double Relief::stretch_at(const Eigen::Vector2d& place_px) const {
  return ground.known() ? stretch_of_height(ground.height_m(place_px)) : 1;
}

Relief relief_of(const LocalMap& map, const LocalMap& below, const std::vector<SpotHeight>& landmarks,
                 const PriorNadir& nadir) {
  Relief relief;
  relief.height_agl_m = nadir.height_agl_m;
  GroundPoints points;
  points.add(map, Eigen::Vector2d::Zero());
  points.add(below, below.reference_px - map.reference_px);
  relief.is_sparse = points.places_px.size() < kFewHeights;
  if (relief.is_sparse) {
    for (const SpotHeight& spot : landmarks) points.add(spot.place_px, spot.height_m);
  }
  if (points.places_px.empty()) return relief;
  relief.ground =
      GroundHeights(points.places_px, points.heights_m, relief.is_sparse ? kLevelSparse_px : kLevelFeatures_px);
  relief.below_m = relief.ground.height_m(nadir.place_px);
  const double spread_m = relief.is_sparse ? sparse_spread_m(relief.ground, nadir, relief.below_m)
                                           : height_spread_m(points, nadir, relief.below_m);
  relief.scale_sigma = std::min(spread_m / nadir.height_agl_m, kMostReliefSigma);
  for (std::size_t i = 0; i < map.features.size(); ++i) {
    const auto own_m = static_cast<double>(map.ground_height_m[i]);
    const double stretch =
        std::isfinite(own_m) ? relief.stretch_of_height(own_m) : relief.stretch_at(place_of(map.features.features[i]));
    relief.stretch.push_back(static_cast<float>(stretch));
  }
  return relief;
}

RectifiedFrame laid_over_relief(const RectifiedFrame& level, const Relief& relief, const Eigen::Vector2d& nadir_px,
                                double px_per_pixel) {
  if (!relief.ground.known() || level.gray.empty()) return level;
  const cv::Mat pixels = level_pixels(level, relief, nadir_px, px_per_pixel);
  RectifiedFrame laid = level;
  laid.gray = laid.valid = cv::Mat();  // not those of `level`
  cv::remap(level.gray, laid.gray, pixels, {}, cv::INTER_LINEAR, cv::BORDER_CONSTANT, 0);
  cv::remap(level.valid, laid.valid, pixels, {}, cv::INTER_LINEAR, cv::BORDER_CONSTANT, 0);
  laid.valid = laid.valid == 255;
  laid.gray.setTo(0, ~laid.valid);
  return laid;
}

double relief_frame_bytes(double side_px) {
  constexpr double kPerPixel = 2 * sizeof(float) + 6;  // positions, two pictures and what is made of them on the way
  return kPerPixel * side_px * side_px;
}

}  // namespace pilotage
