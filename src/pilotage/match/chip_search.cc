#include "pilotage/match/chip_search.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "pilotage/base/error.h"
#include "pilotage/match/chip_correlation.h"
#include "pilotage/match/chip_templates.h"
#include "pilotage/vision/direction_field.h"
#include "pilotage/vision/masked_correlation.h"

namespace pilotage {
namespace {

constexpr double kFlatVariance = 1e-3;  // of directions, whose length is at most 1
constexpr double kMaxPositionPx = 1e9;  // of mosaic pixels: int holds it
constexpr int kBlockPositions = 256;    // along each axis, compared at a time
constexpr std::size_t kCoarsePlaces = 8;
constexpr int kStep = 2;  // the coarse resolution, in pixels of the mosaic
constexpr int kWideStep = 4;
/// Windows to each side, in pixels of the mosaic, beyond which kWideStep is taken.
constexpr double kWideHalfWidthPx = 320;

bool usable(const ChipSearchOptions& options) {
  return options.min_overlap >= 0 && options.exclusion_px >= 0 && options.exclusion_px <= kMaxMosaicSidePx;
}

bool usable(const ChipMosaic& mosaic) {
  return mosaic.steps.type() == CV_8UC1 && !mosaic.steps.empty() && mosaic.valid.type() == CV_8UC1 &&
         mosaic.valid.size() == mosaic.steps.size() && mosaic.factor >= 1;
}

bool usable(const ChipHypothesis& hypothesis) {
  return std::isfinite(hypothesis.yaw_deg) && hypothesis.scale >= 0.5 && hypothesis.scale <= 2;
}

bool usable(const std::vector<ChipHypothesis>& hypotheses) {
  return !hypotheses.empty() &&
         std::all_of(hypotheses.begin(), hypotheses.end(), [](const auto& h) { return usable(h); });
}

/// The whole positions of the nadir point along each axis, ends excluded: those of the window at which the frame meets
/// the mosaic at all.
struct Positions {
  cv::Range cols;
  cv::Range rows;
};

Positions positions(const Eigen::Vector2d& center, double half_width, const Canvas& canvas, const ChipMosaic& mosaic) {
  const auto along = [&](double middle, int first, int size, int mosaic_size) {
    const double low = std::max(std::floor(middle - half_width), -static_cast<double>(first) - size + 1);
    const double high = std::min(std::ceil(middle + half_width), static_cast<double>(mosaic_size) - first - 1);
    if (!(low <= high)) return cv::Range(0, 0);
    return cv::Range(static_cast<int>(low), static_cast<int>(high) + 1);
  };
  return {along(center.x(), canvas.left, canvas.width, mosaic.steps.cols),
          along(center.y(), canvas.top, canvas.height, mosaic.steps.rows)};
}

/// Blocks of `positions`, one after another.
std::vector<cv::Range> blocks_of(int positions) {
  std::vector<cv::Range> blocks;
  for (int first = 0; first < positions; first += kBlockPositions) {
    blocks.emplace_back(first, std::min(first + kBlockPositions, positions));
  }
  return blocks;
}

/// A pixel for each `step` in both directions: means, and what is valid in all of them.
cv::Mat reduced(const cv::Mat& pixels, int step) {
  const cv::Size size(pixels.cols / step, pixels.rows / step);
  cv::Mat result;
  cv::resize(pixels(cv::Rect({0, 0}, size * step)), result, size, 0, 0, cv::INTER_AREA);
  return result;
}

cv::Mat reduced_mask(const cv::Mat& valid, int step) {
  cv::Mat result;
  const cv::Mat kernel = cv::Mat::ones(step, step, CV_8UC1);
  cv::erode(valid, result, kernel, {0, 0}, 1, cv::BORDER_CONSTANT, 0);  // of the pixels right of it and below
  const cv::Size size(valid.cols / step, valid.rows / step);
  cv::resize(result(cv::Rect({0, 0}, size * step)), result, size, 0, 0, cv::INTER_NEAREST);
  return result;
}

/// The highest correlation of any template at every step-th position along rows and columns, at as coarse a resolution.
struct CoarseSurface {
  int step = kStep;
  cv::Mat ncc;    // CV_32F
  cv::Mat index;  // CV_16U: of the template
};

/// The templates at the coarse resolution.
struct CoarseTemplates {
  int step = kStep;
  cv::Mat mask;
  std::vector<cv::Mat> z;
};

/// Compares them over a rectangle of the mosaic: raises `ncc` and keeps whose it is. Where there are no chips nothing
/// is computed.
void compare_block(const CoarseTemplates& templates, const ChipMosaic& mosaic, const cv::Rect& rect,
                   const ChipSearchOptions& options, cv::Mat ncc, cv::Mat index, const Checkpoint& checkpoint) {
  const cv::Mat& mask = templates.mask;
  const cv::Rect on_mosaic = rect & cv::Rect({0, 0}, mosaic.valid.size());
  const double needed_px = templates.step * templates.step * options.min_overlap * cv::countNonZero(mask);
  if (on_mosaic.empty() || cv::countNonZero(mosaic.valid(on_mosaic)) < needed_px) return;
  pass(checkpoint);
  const ChipRegion region = cut_chip_region(mosaic, rect);
  const cv::Mat z = reduced(region.z, templates.step);
  const MaskedCorrelation correlation(mask, z, reduced_mask(region.valid, templates.step), options.min_overlap,
                                      kFlatVariance, opencv_sums_of_products(mask.size(), z.size()));
  for (std::size_t i = 0; i < templates.z.size(); ++i) {
    pass(checkpoint);
    const cv::Mat surface = correlation.surface(templates.z[i]);
    index.setTo(static_cast<int>(i), surface > ncc);
    cv::max(ncc, surface, ncc);
  }
}

/// In blocks: memory does not grow with the window but by the best at each position.
CoarseSurface coarse_surface(const ChipTemplates& templates, int step, const ChipMosaic& mosaic,
                             const Positions& positions, const ChipSearchOptions& options,
                             const Checkpoint& checkpoint) {
  CoarseTemplates coarse{step, reduced_mask(templates.mask, step), {}};
  for (const cv::Mat& z : templates.z) coarse.z.push_back(reduced(z, step));
  const cv::Size size((positions.cols.size() + step - 1) / step, (positions.rows.size() + step - 1) / step);
  CoarseSurface surface{step, cv::Mat(size, CV_32F, cv::Scalar(MaskedCorrelation::kNotCompared)),
                        cv::Mat::zeros(size, CV_16U)};
  for (const cv::Range& rows : blocks_of(size.height)) {
    for (const cv::Range& cols : blocks_of(size.width)) {
      const cv::Rect rect(positions.cols.start + step * cols.start + templates.canvas.left,
                          positions.rows.start + step * rows.start + templates.canvas.top,
                          step * (cols.size() - 1 + coarse.mask.cols), step * (rows.size() - 1 + coarse.mask.rows));
      compare_block(coarse, mosaic, rect, options, surface.ncc(rows, cols), surface.index(rows, cols), checkpoint);
    }
  }
  return surface;
}

struct CoarsePlace {
  cv::Point at;  // position of the nadir point in the mosaic
  std::size_t index = 0;
};

/// The highest places of the surface that are farther apart than `exclusion_px` along a row or a column, the highest
/// first.
std::vector<CoarsePlace> highest_places(CoarseSurface surface, const Positions& positions, double exclusion_px) {
  const int exclusion = static_cast<int>(std::ceil(exclusion_px / surface.step));
  std::vector<CoarsePlace> places;
  while (places.size() < kCoarsePlaces) {
    double highest = 0;
    cv::Point at;
    cv::minMaxLoc(surface.ncc, nullptr, &highest, nullptr, &at);
    if (highest <= 0) break;
    places.push_back({{positions.cols.start + surface.step * at.x, positions.rows.start + surface.step * at.y},
                      static_cast<std::size_t>(surface.index.at<std::uint16_t>(at))});
    const cv::Rect around(at.x - exclusion, at.y - exclusion, 2 * exclusion + 1, 2 * exclusion + 1);
    surface.ncc(around & cv::Rect({0, 0}, surface.ncc.size())).setTo(MaskedCorrelation::kNotCompared);
  }
  return places;
}

/// Every second one, of three turns by three scales the middle and the corners: at a coarse resolution they are near
/// enough to each other.
std::vector<ChipHypothesis> every_second(const std::vector<ChipHypothesis>& hypotheses) {
  std::vector<ChipHypothesis> kept;
  for (std::size_t i = 0; i < hypotheses.size(); i += 2) kept.push_back(hypotheses[i]);
  return kept;
}

/// The place of the highest correlation about `at`, of the frame under one hypothesis.
ChipMatch match_near(const ChipTemplates& templates, std::size_t index, const ChipHypothesis& hypothesis,
                     const ChipMosaic& mosaic, const cv::Point& at, int reach_px, const ChipSearchOptions& options) {
  const int mask_px = cv::countNonZero(templates.mask);
  const ChipPeak peak = climb(templates, index, mosaic, at, reach_px, options.min_overlap * mask_px);
  ChipMatch match;
  if (!(peak.ncc > 0)) return match;
  match.found = true;
  match.nadir_px = mosaic.level_from_mosaic(peak.at_px);
  match.yaw_deg = hypothesis.yaw_deg;
  match.scale = hypothesis.scale;
  match.ncc = peak.ncc;
  match.pixels = peak.pixels;
  match.overlap = static_cast<double>(peak.pixels) / mask_px;
  return match;
}

}  // namespace

ChipFrame make_chip_frame(const RectifiedFrame& frame) {
  const Eigen::Vector2d nadir_px = frame.pixel_from_ground({0, 0});
  if (frame.status != RectifyStatus::kOk || frame.gray.type() != CV_8UC1 || frame.gray.empty() ||
      frame.valid.type() != CV_8UC1 || frame.valid.size() != frame.gray.size() || !(frame.gsd_m > 0) ||
      std::max(frame.gray.cols, frame.gray.rows) > kMaxMosaicSidePx ||
      !(nadir_px.cwiseAbs().maxCoeff() < kMaxPositionPx / 4)) {
    return {};
  }
  const DirectionField field = direction_field(frame.gray, frame.valid);
  return {field.z, field.valid, nadir_px};
}

std::vector<ChipHypothesis> chip_hypotheses(double yaw_deg, int yaw_steps, double scale, int scale_steps) {
  if (yaw_steps < 1 || yaw_steps > 101 || scale_steps < 1 || scale_steps > 101) {
    throw UsageError("yaw_steps = " + std::to_string(yaw_steps) + " or scale_steps = " + std::to_string(scale_steps) +
                     " is outside [1, 101]");
  }
  const auto step = [](int index, int count) { return count == 1 ? 0.0 : 2.0 * index / (count - 1) - 1; };
  std::vector<ChipHypothesis> hypotheses;
  for (int i = 0; i < yaw_steps; ++i) {
    for (int k = 0; k < scale_steps; ++k) {
      hypotheses.push_back({step(i, yaw_steps) * yaw_deg, 1 + step(k, scale_steps) * scale});
    }
  }
  return hypotheses;
}

std::vector<ChipMatch> search_chips(const ChipFrame& frame, const ChipMosaic& mosaic, const Eigen::Vector2d& center_px,
                                    double half_width_px, const std::vector<ChipHypothesis>& hypotheses,
                                    const ChipSearchOptions& options, const Checkpoint& checkpoint) {
  if (!usable(options) || frame.z.empty() || !usable(mosaic) || !usable(hypotheses) || !center_px.allFinite() ||
      !(half_width_px >= 0)) {
    return {};
  }
  const auto coarse = every_second(hypotheses);
  const auto templates = make_chip_templates(frame, coarse);
  const double half_width = half_width_px / mosaic.factor;
  const int step = half_width > kWideHalfWidthPx ? kWideStep : kStep;
  if (!templates || std::min(templates->canvas.width, templates->canvas.height) < step) return {};
  const Positions window = positions(mosaic.mosaic_from_level(center_px), half_width, templates->canvas, mosaic);
  if (window.cols.empty() || window.rows.empty()) return {};
  std::vector<ChipMatch> matches;
  const CoarseSurface surface = coarse_surface(*templates, step, mosaic, window, options, checkpoint);
  for (const CoarsePlace& place : highest_places(surface, window, options.exclusion_px)) {
    pass(checkpoint);
    const ChipMatch match =
        match_near(*templates, place.index, coarse[place.index], mosaic, place.at, step + 1, options);
    if (match.found) matches.push_back(match);
  }
  const auto better = [](const ChipMatch& a, const ChipMatch& b) { return a.ncc > b.ncc; };
  std::stable_sort(matches.begin(), matches.end(), better);
  if (matches.empty()) return matches;
  const auto all = make_chip_templates(frame, hypotheses);
  if (!all) return matches;
  const Eigen::Vector2d best_px = mosaic.mosaic_from_level(matches.front().nadir_px);
  const cv::Point at(static_cast<int>(std::lround(best_px.x())), static_cast<int>(std::lround(best_px.y())));
  for (std::size_t i = 0; i < hypotheses.size(); ++i) {
    pass(checkpoint);
    const ChipMatch match = match_near(*all, i, hypotheses[i], mosaic, at, step + 1, options);
    if (match.found && better(match, matches.front())) matches.front() = match;
  }
  return matches;
}

double rival_ncc(const std::vector<ChipMatch>& matches, const Eigen::Vector2d& nadir_px, double exclusion_px) {
  double highest = 0;
  for (const ChipMatch& match : matches) {
    if ((match.nadir_px - nadir_px).cwiseAbs().maxCoeff() > exclusion_px) highest = std::max(highest, match.ncc);
  }
  return highest;
}

double chip_search_bytes(double frame_side_px, double half_width_px, std::size_t hypotheses) {
  const double positions = 2 * half_width_px + 3;
  const double turned_side_px = 1.5 * frame_side_px + 2;
  const double step = half_width_px > kWideHalfWidthPx ? kWideStep : kStep;
  const double block_side_px = std::min<double>(kBlockPositions, positions / step) + 1.1 * turned_side_px / step + 16;
  constexpr double kBlockPlanes = 40;  // of floats: directions, spectra, sums, surfaces, each with its copy
  const double coarse_side_px = positions / step;
  return 7 * coarse_side_px * coarse_side_px + 4 * kBlockPlanes * block_side_px * block_side_px +
         13 * step * step * block_side_px * block_side_px +
         (9 * static_cast<double>(hypotheses + 2) + 30) * turned_side_px * turned_side_px;
}

ChipMatch confirm_chip_match(const ChipFrame& frame, const ChipMosaic& mosaic, const ChipMatch& candidate, int reach_px,
                             const ChipSearchOptions& options) {
  const ChipHypothesis hypothesis{candidate.yaw_deg, candidate.scale};
  if (!usable(options) || frame.z.empty() || !usable(mosaic) || !usable(hypothesis) || reach_px < 0) return {};
  const Eigen::Vector2d at = mosaic.mosaic_from_level(candidate.nadir_px);
  if (!(at.cwiseAbs().maxCoeff() < kMaxPositionPx)) return {};
  const auto templates = make_chip_templates(frame, {hypothesis});
  if (!templates) return {};
  const cv::Point whole(static_cast<int>(std::lround(at.x())), static_cast<int>(std::lround(at.y())));
  return match_near(*templates, 0, hypothesis, mosaic, whole, reach_px, options);
}

}  // namespace pilotage
