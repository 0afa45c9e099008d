#include "pilotage/match/chip_search.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "pilotage/base/error.h"
#include "pilotage/match/highest_places.h"
#include "pilotage/match/local_contrast.h"
#include "pilotage/match/reduced_picture.h"
#include "pilotage/vision/masked_correlation.h"

namespace pilotage {
namespace {

constexpr double kFlatVariance = 1e-3;  // of gray values or of local contrast: what is even after rounding
constexpr double kMaxPositionPx = 1e9;  // of mosaic pixels: int holds it
constexpr int kBlockPositions = 256;    // along each axis, compared at a time
constexpr std::size_t kCoarsePlaces = 8;
constexpr int kCoarseReachPx = 3;  // about a place that was found at half the resolution

/// The frame's nadir point in its own pixels.
Eigen::Vector2d nadir_of(const RectifiedFrame& frame) {
  return frame.pixel_from_ground({0, 0});
}

/// Whole pixels about the nadir point: pixel (c, r) of a canvas covers c + left … c + left + 1 pixels right of it.
struct Canvas {
  int left = 0;
  int top = 0;
  int width = 0;
  int height = 0;
};

/// The pixels about the nadir point that lie within the frame's rectangle turned and scaled.
Canvas bounds_of(const RectifiedFrame& frame, const ChipHypothesis& hypothesis) {
  const Eigen::Vector2d nadir = nadir_of(frame);
  const double turn = hypothesis.yaw_deg * std::numbers::pi / 180;
  Eigen::Vector2d low(kMaxPositionPx, kMaxPositionPx);
  Eigen::Vector2d high = -low;
  for (const double x : {0.0, static_cast<double>(frame.gray.cols)}) {
    for (const double y : {0.0, static_cast<double>(frame.gray.rows)}) {
      const Eigen::Vector2d arm = hypothesis.scale * (Eigen::Vector2d(x, y) - nadir);
      const Eigen::Vector2d corner(std::cos(turn) * arm.x() - std::sin(turn) * arm.y(),
                                   std::sin(turn) * arm.x() + std::cos(turn) * arm.y());
      low = low.cwiseMin(corner);
      high = high.cwiseMax(corner);
    }
  }
  const int left = static_cast<int>(std::floor(low.x()));
  const int top = static_cast<int>(std::floor(low.y()));
  return {left, top, static_cast<int>(std::ceil(high.x())) - left, static_cast<int>(std::ceil(high.y())) - top};
}

Canvas intersection(const Canvas& a, const Canvas& b) {
  const int left = std::max(a.left, b.left);
  const int top = std::max(a.top, b.top);
  return {left, top, std::min(a.left + a.width, b.left + b.width) - left,
          std::min(a.top + a.height, b.top + b.height) - top};
}

/// What is compared of a picture.
cv::Mat comparable(const cv::Mat& gray, const cv::Mat& valid, double contrast_sigma_px) {
  if (contrast_sigma_px > 0) return local_contrast(gray, valid, contrast_sigma_px);
  cv::Mat result;
  gray.convertTo(result, CV_32F);
  return result;
}

struct Warped {
  cv::Mat pixels;  // CV_32F
  cv::Mat valid;   // CV_8U: 255 where the four pixels that linear interpolation needs are valid
};

/// The frame turned, scaled and moved: canvas position p shows the frame at nadir + R(−yaw)·(p − move)/scale.
Warped warp(const RectifiedFrame& frame, const cv::Mat& pixels, const ChipHypothesis& hypothesis, const Canvas& canvas,
            const Eigen::Vector2d& move) {
  const double turn = hypothesis.yaw_deg * std::numbers::pi / 180;
  const double c = std::cos(turn) / hypothesis.scale;
  const double s = std::sin(turn) / hypothesis.scale;
  const Eigen::Vector2d nadir = nadir_of(frame);
  // From the centre of canvas pixel (0, 0), relative to the nadir point; OpenCV's first centre is (0, 0).
  const Eigen::Vector2d first(canvas.left + 0.5 - move.x(), canvas.top + 0.5 - move.y());
  const cv::Matx23d map(c, s, nadir.x() + c * first.x() + s * first.y() - 0.5,  //
                        -s, c, nadir.y() - s * first.x() + c * first.y() - 0.5);
  const cv::Size size(canvas.width, canvas.height);
  constexpr int kFlags = cv::INTER_LINEAR | cv::WARP_INVERSE_MAP;
  Warped result;
  cv::warpAffine(pixels, result.pixels, map, size, kFlags, cv::BORDER_CONSTANT, 0);
  cv::warpAffine(frame.valid, result.valid, map, size, kFlags, cv::BORDER_CONSTANT, 0);
  result.valid = result.valid == 255;
  return result;
}

bool usable(const ChipSearchOptions& options) {
  return options.contrast_sigma_px >= 0 && options.contrast_sigma_px <= 100 && options.min_overlap >= 0 &&
         options.exclusion_px >= 0 && options.exclusion_px <= kMaxMosaicSidePx;
}

bool usable(const ChipHypothesis& hypothesis) {
  return std::isfinite(hypothesis.yaw_deg) && hypothesis.scale >= 0.5 && hypothesis.scale <= 2;
}

/// What is compared of a rectangle of the mosaic, which may reach beyond it, where nothing is valid.
struct Region {
  cv::Mat pixels;  // CV_32F
  cv::Mat valid;
};

Region cut_region(const ChipMosaic& mosaic, const cv::Rect& rect, double contrast_sigma_px) {
  // The surroundings that local contrast sees belong to it.
  const int margin = static_cast<int>(std::ceil(4 * contrast_sigma_px));
  const cv::Rect grown(rect.x - margin, rect.y - margin, rect.width + 2 * margin, rect.height + 2 * margin);
  const cv::Rect whole({0, 0}, mosaic.gray.size());
  Region region{cv::Mat::zeros(rect.size(), CV_32F), cv::Mat::zeros(rect.size(), CV_8UC1)};
  const cv::Rect inside = rect & whole;
  if (inside.empty()) return region;
  const cv::Rect seen = grown & whole;
  const cv::Mat pixels = comparable(mosaic.gray(seen), mosaic.valid(seen), contrast_sigma_px);
  pixels(inside - seen.tl()).copyTo(region.pixels(inside - rect.tl()));
  mosaic.valid(inside).copyTo(region.valid(inside - rect.tl()));
  return region;
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
  return {along(center.x(), canvas.left, canvas.width, mosaic.gray.cols),
          along(center.y(), canvas.top, canvas.height, mosaic.gray.rows)};
}

/// Position of the vertex of the parabola through three values, from the middle one; 0 when it is not a maximum.
double vertex(double before, double at, double after) {
  const double curvature = before - 2 * at + after;
  return curvature < 0 ? std::clamp(0.5 * (before - after) / curvature, -0.5, 0.5) : 0;
}

/// The peak of `surface` at `at` to a fraction of a pixel, along each axis by itself.
Eigen::Vector2d peak_offset(const cv::Mat& surface, const cv::Point& at) {
  const auto value = [&](int dx, int dy) { return static_cast<double>(surface.at<float>(at.y + dy, at.x + dx)); };
  const auto usable_pair = [&](double a, double b) { return a > MaskedCorrelation::kNotCompared && b > -2; };
  Eigen::Vector2d offset(0, 0);
  if (at.x > 0 && at.x + 1 < surface.cols && usable_pair(value(-1, 0), value(1, 0))) {
    offset.x() = vertex(value(-1, 0), value(0, 0), value(1, 0));
  }
  if (at.y > 0 && at.y + 1 < surface.rows && usable_pair(value(0, -1), value(0, 1))) {
    offset.y() = vertex(value(0, -1), value(0, 0), value(0, 1));
  }
  return offset;
}

/// The highest value farther than `exclusion` from `at` along a row or a column.
double highest_elsewhere(const cv::Mat& surface, const cv::Point& at, double exclusion) {
  cv::Mat mask(surface.size(), CV_8UC1, cv::Scalar(255));
  const int reach = static_cast<int>(std::floor(exclusion));
  const cv::Rect lobe(at.x - reach, at.y - reach, 2 * reach + 1, 2 * reach + 1);
  mask(lobe & cv::Rect({0, 0}, surface.size())).setTo(0);
  double highest = 0;
  if (cv::countNonZero(mask) > 0) cv::minMaxLoc(surface, nullptr, &highest, nullptr, nullptr, mask);
  return std::max(highest, 0.0);
}

/// The frame under all hypotheses, over the pixels that all of them show.
struct Templates {
  Canvas canvas;
  Eigen::Vector2d move;  // of the nadir point from the canvas position (0, 0)
  cv::Mat mask;
  std::vector<cv::Mat> pixels;
};

std::optional<Templates> make_templates(const RectifiedFrame& frame, const std::vector<ChipHypothesis>& hypotheses,
                                        const Eigen::Vector2d& move, double contrast_sigma_px) {
  Canvas canvas = bounds_of(frame, hypotheses.front());
  for (const ChipHypothesis& hypothesis : hypotheses) canvas = intersection(canvas, bounds_of(frame, hypothesis));
  if (canvas.width < 1 || canvas.height < 1) return std::nullopt;
  Templates result;
  result.move = move;
  const cv::Mat pixels = comparable(frame.gray, frame.valid, contrast_sigma_px);
  result.mask = cv::Mat(canvas.height, canvas.width, CV_8UC1, cv::Scalar(255));
  for (const ChipHypothesis& hypothesis : hypotheses) {
    const Warped warped = warp(frame, pixels, hypothesis, canvas, move);
    result.mask &= warped.valid;
    result.pixels.push_back(warped.pixels);
  }
  const cv::Rect used = cv::boundingRect(result.mask);
  if (used.empty()) return std::nullopt;
  result.canvas = {canvas.left + used.x, canvas.top + used.y, used.width, used.height};
  result.mask = result.mask(used);
  for (cv::Mat& warped : result.pixels) warped = warped(used);
  return result;
}

/// The best place of all templates, and the surface it lies on.
struct Best {
  std::size_t index = 0;
  cv::Mat surface;
  cv::Mat counts;
  cv::Point at;     // in the surface
  cv::Point first;  // position of the surface's first
  double ncc = -2;
};

/// Positions along an axis: those of a block, and with its neighbours, which say where between positions a peak lies.
struct Block {
  cv::Range own;
  cv::Range seen;
};

std::vector<Block> blocks_of(const cv::Range& positions) {
  std::vector<Block> blocks;
  for (int first = positions.start; first < positions.end; first += kBlockPositions) {
    const int end = std::min(first + kBlockPositions, positions.end);
    blocks.push_back({{first, end}, {std::max(first - 1, positions.start), std::min(end + 1, positions.end)}});
  }
  return blocks;
}

/// Compares the templates in one block: raises `highest`, of the block's own positions, and `best`.
void compare_block(const Templates& templates, const ChipMosaic& mosaic, const Block& cols, const Block& rows,
                   const ChipSearchOptions& options, cv::Mat highest, Best& best, const Checkpoint& checkpoint) {
  const Canvas& canvas = templates.canvas;
  const cv::Rect rect(cols.seen.start + canvas.left, rows.seen.start + canvas.top, cols.seen.size() - 1 + canvas.width,
                      rows.seen.size() - 1 + canvas.height);
  const cv::Rect on_mosaic = rect & cv::Rect({0, 0}, mosaic.valid.size());
  const double needed_px = options.min_overlap * cv::countNonZero(templates.mask);
  if (on_mosaic.empty() || cv::countNonZero(mosaic.valid(on_mosaic)) < needed_px) return;
  pass(checkpoint);
  const Region region = cut_region(mosaic, rect, options.contrast_sigma_px);
  const MaskedCorrelation correlation(templates.mask, region.pixels, region.valid, options.min_overlap, kFlatVariance,
                                      opencv_sums_of_products(templates.mask.size(), region.pixels.size()));
  const cv::Rect own(cols.own.start - cols.seen.start, rows.own.start - rows.seen.start, cols.own.size(),
                     rows.own.size());
  for (std::size_t i = 0; i < templates.pixels.size(); ++i) {
    pass(checkpoint);
    const cv::Mat surface = correlation.surface(templates.pixels[i]);
    cv::max(highest, surface(own), highest);
    double ncc = 0;
    cv::Point at;
    cv::minMaxLoc(surface(own), nullptr, &ncc, nullptr, &at);
    if (ncc <= best.ncc) continue;
    best = {i, surface, correlation.counts(), at + own.tl(), {cols.seen.start, rows.seen.start}, ncc};
  }
}

/// Compares the templates at the whole positions cols × rows of the nadir point, and fills in everything but the
/// hypothesis. In blocks: memory does not grow with the window but by the best at each position, and where there are no
/// chips nothing is computed.
ChipMatch compare(const Templates& templates, const ChipMosaic& mosaic, const cv::Range& cols, const cv::Range& rows,
                  const ChipSearchOptions& options, std::size_t& index, const Checkpoint& checkpoint) {
  cv::Mat highest(rows.size(), cols.size(), CV_32F, cv::Scalar(MaskedCorrelation::kNotCompared));
  Best best;
  for (const Block& block_rows : blocks_of(rows)) {
    for (const Block& block_cols : blocks_of(cols)) {
      const cv::Rect own(block_cols.own.start - cols.start, block_rows.own.start - rows.start, block_cols.own.size(),
                         block_rows.own.size());
      compare_block(templates, mosaic, block_cols, block_rows, options, highest(own), best, checkpoint);
    }
  }
  ChipMatch match;
  if (best.ncc <= 0) return match;
  const cv::Point whole = best.first + best.at;
  const Eigen::Vector2d at(whole.x, whole.y);
  match.found = true;
  match.nadir_px = mosaic.level_from_mosaic(at + peak_offset(best.surface, best.at) + templates.move);
  match.ncc = best.ncc;
  match.rival_ncc = highest_elsewhere(highest, whole - cv::Point(cols.start, rows.start), options.exclusion_px);
  match.pixels = static_cast<int>(best.counts.at<float>(best.at));
  match.overlap = static_cast<double>(match.pixels) / cv::countNonZero(templates.mask);
  index = best.index;
  return match;
}

/// The highest correlation of any template at every second position along rows and columns, at half the resolution.
cv::Mat coarse_surface(const Templates& templates, const ChipMosaic& mosaic, const cv::Range& cols,
                       const cv::Range& rows, const ChipSearchOptions& options, const Checkpoint& checkpoint) {
  const cv::Mat mask = reduced_mask(templates.mask, 2);
  std::vector<cv::Mat> halves;
  for (const cv::Mat& pixels : templates.pixels) halves.push_back(reduced_picture(pixels, 2));
  const double needed_px = 4 * options.min_overlap * cv::countNonZero(mask);
  cv::Mat highest((rows.size() + 1) / 2, (cols.size() + 1) / 2, CV_32F, cv::Scalar(MaskedCorrelation::kNotCompared));
  for (const Block& block_rows : blocks_of({0, highest.rows})) {
    for (const Block& block_cols : blocks_of({0, highest.cols})) {
      const cv::Rect own(block_cols.own.start, block_rows.own.start, block_cols.own.size(), block_rows.own.size());
      const cv::Rect rect(cols.start + 2 * own.x + templates.canvas.left, rows.start + 2 * own.y + templates.canvas.top,
                          2 * (own.width - 1 + mask.cols), 2 * (own.height - 1 + mask.rows));
      const cv::Rect on_mosaic = rect & cv::Rect({0, 0}, mosaic.valid.size());
      if (on_mosaic.empty() || cv::countNonZero(mosaic.valid(on_mosaic)) < needed_px) continue;
      pass(checkpoint);
      const Region region = cut_region(mosaic, rect, options.contrast_sigma_px);
      const cv::Mat pixels = reduced_picture(region.pixels, 2);
      const MaskedCorrelation correlation(mask, pixels, reduced_mask(region.valid, 2), options.min_overlap,
                                          kFlatVariance, opencv_sums_of_products(mask.size(), pixels.size()));
      cv::Mat here = highest(own);
      for (const cv::Mat& half : halves) {
        pass(checkpoint);
        cv::max(here, correlation.surface(half), here);
      }
    }
  }
  return highest;
}

bool usable(const std::vector<ChipHypothesis>& hypotheses) {
  return !hypotheses.empty() &&
         std::all_of(hypotheses.begin(), hypotheses.end(), [](const auto& h) { return usable(h); });
}

}  // namespace

bool can_be_compared(const RectifiedFrame& frame) {
  return frame.status == RectifyStatus::kOk && frame.gray.type() == CV_8UC1 && !frame.gray.empty() &&
         frame.valid.type() == CV_8UC1 && frame.valid.size() == frame.gray.size() && frame.gsd_m > 0 &&
         std::max(frame.gray.cols, frame.gray.rows) <= kMaxMosaicSidePx && nadir_of(frame).allFinite() &&
         nadir_of(frame).cwiseAbs().maxCoeff() < kMaxPositionPx / 4;
}

bool can_be_compared(const ChipMosaic& mosaic) {
  return mosaic.gray.type() == CV_8UC1 && !mosaic.gray.empty() && mosaic.valid.type() == CV_8UC1 &&
         mosaic.valid.size() == mosaic.gray.size() && mosaic.factor >= 1;
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

ChipMatch search_chips(const RectifiedFrame& frame, const ChipMosaic& mosaic, const Eigen::Vector2d& center_px,
                       double half_width_px, const std::vector<ChipHypothesis>& hypotheses,
                       const ChipSearchOptions& options, const Checkpoint& checkpoint) {
  if (!usable(options) || !can_be_compared(frame) || !can_be_compared(mosaic) || !usable(hypotheses) ||
      !center_px.allFinite() || !(half_width_px >= 0)) {
    return {};
  }
  const auto templates = make_templates(frame, hypotheses, Eigen::Vector2d::Zero(), options.contrast_sigma_px);
  if (!templates) return {};
  const Eigen::Vector2d center = mosaic.mosaic_from_level(center_px);
  const auto [cols, rows] = positions(center, half_width_px / mosaic.factor, templates->canvas, mosaic);
  if (cols.empty() || rows.empty()) return {};
  std::size_t index = 0;
  ChipMatch match = compare(*templates, mosaic, cols, rows, options, index, checkpoint);
  match.yaw_deg = hypotheses[index].yaw_deg;
  match.scale = hypotheses[index].scale;
  return match;
}

ChipMatch search_chips_coarsely(const RectifiedFrame& frame, const ChipMosaic& mosaic, const Eigen::Vector2d& center_px,
                                double half_width_px, const std::vector<ChipHypothesis>& coarse_hypotheses,
                                const std::vector<ChipHypothesis>& hypotheses, const ChipSearchOptions& options,
                                const Checkpoint& checkpoint) {
  if (!usable(options) || !can_be_compared(frame) || !can_be_compared(mosaic) || !usable(hypotheses) ||
      !usable(coarse_hypotheses) || !center_px.allFinite() || !(half_width_px >= 0)) {
    return {};
  }
  const Eigen::Vector2d center = mosaic.mosaic_from_level(center_px);
  const auto coarse = make_templates(frame, coarse_hypotheses, Eigen::Vector2d::Zero(), options.contrast_sigma_px);
  const auto fine = make_templates(frame, hypotheses, Eigen::Vector2d::Zero(), options.contrast_sigma_px);
  if (!coarse || !fine || std::min(coarse->canvas.width, coarse->canvas.height) < 2) return {};
  const auto [cols, rows] = positions(center, half_width_px / mosaic.factor, coarse->canvas, mosaic);
  if (cols.empty() || rows.empty()) return {};
  const cv::Mat surface = coarse_surface(*coarse, mosaic, cols, rows, options, checkpoint);
  ChipMatch best;
  double rival_ncc = 0;
  const int exclusion = static_cast<int>(std::ceil(options.exclusion_px / 2));
  for (const cv::Point& place : highest_places(surface, kCoarsePlaces, exclusion)) {
    pass(checkpoint);
    const cv::Point at(cols.start + 2 * place.x, rows.start + 2 * place.y);
    std::size_t index = 0;
    ChipMatch match = compare(*fine, mosaic, {at.x - kCoarseReachPx, at.x + kCoarseReachPx + 1},
                              {at.y - kCoarseReachPx, at.y + kCoarseReachPx + 1}, options, index, {});
    if (!match.found) continue;
    match.yaw_deg = hypotheses[index].yaw_deg;
    match.scale = hypotheses[index].scale;
    rival_ncc = std::max(rival_ncc, std::min(match.ncc, best.ncc));
    if (match.ncc > best.ncc) best = match;
  }
  best.rival_ncc = rival_ncc;
  return best;
}

double chip_search_bytes(double frame_side_px, double half_width_px, std::size_t hypotheses) {
  const double positions = 2 * half_width_px + 3;
  const double turned_side_px = 1.5 * frame_side_px + 2;
  const double block_side_px = std::min<double>(kBlockPositions + 2, positions) + 1.1 * turned_side_px + 16;
  constexpr double kBlockPlanes = 24;  // of floats: contrast, spectra, sums, surfaces, each with its copy
  return 4 * positions * positions + 4 * kBlockPlanes * block_side_px * block_side_px +
         5 * static_cast<double>(hypotheses + 2) * turned_side_px * turned_side_px;
}

ChipMatch confirm_chip_match(const RectifiedFrame& frame, const ChipMosaic& mosaic, const ChipMatch& candidate,
                             int reach_px, const ChipSearchOptions& options) {
  ChipMatch match = candidate;
  match.found = false;
  const ChipHypothesis hypothesis{candidate.yaw_deg, candidate.scale};
  if (!usable(options) || !can_be_compared(frame) || !can_be_compared(mosaic) || !usable(hypothesis) || reach_px < 0)
    return match;
  const Eigen::Vector2d at = mosaic.mosaic_from_level(candidate.nadir_px);
  if (!(at.cwiseAbs().maxCoeff() < kMaxPositionPx)) return match;
  const Eigen::Vector2d whole = at.array().floor();
  const auto templates = make_templates(frame, {hypothesis}, at - whole, options.contrast_sigma_px);
  if (!templates) return match;
  const auto [cols, rows] = positions(whole, reach_px, templates->canvas, mosaic);
  if (cols.empty() || rows.empty()) return match;
  std::size_t index = 0;
  const ChipMatch found = compare(*templates, mosaic, cols, rows, options, index, {});
  if (!found.found) return match;
  match.found = true;
  match.nadir_px = found.nadir_px;
  match.ncc = found.ncc;
  match.overlap = found.overlap;
  match.pixels = found.pixels;
  return match;
}

}  // namespace pilotage
