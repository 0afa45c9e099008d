#include "pilotage/vision/features.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <numeric>
#include <string>

#include <opencv2/imgproc.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/parallel.h"
#include "pilotage/geo/tile_groups.h"
#include "pilotage/vision/feature_descriptor.h"
#include "pilotage/vision/feature_detector.h"
#include "pilotage/vision/feature_octave.h"

namespace pilotage {
namespace {

/// Corners per pixel of each octave: the same on all, so that each takes a share of the whole in proportion to its
/// pixels.
double corners_per_octave_px(const FeatureOptions& options) {
  double pixels = 0;
  for (int octave = 0; octave < options.octaves; ++octave) pixels += std::pow(octave_scale(options, octave), -2);
  return options.features_per_mpx / 1e6 / pixels;
}

/// A block of the whole image, and the part of it whose features are wanted: those centred in
/// [col_begin, col_end) × [row_begin, row_end) of the whole image.
struct ImageBlock {
  cv::Mat gray;
  cv::Mat valid;
  std::int64_t first_col = 0;
  std::int64_t first_row = 0;
  double col_begin = 0;
  double col_end = 0;
  double row_begin = 0;
  double row_end = 0;
};

/// First octave pixel, counted from the octave's first, whose centre is at or after `position` of the whole image.
int first_centered_from(double position, double scale, std::int64_t octave_first) {
  return static_cast<int>(std::ceil(position / scale - 0.5) - static_cast<double>(octave_first));
}

/// The octave's pixels where a feature may lie: centred in the wanted part, patch inside the octave.
cv::Rect feature_area(const Octave& octave, const ImageBlock& block, int patch_radius) {
  const int left = std::max(first_centered_from(block.col_begin, octave.scale, octave.first_col), patch_radius);
  const int top = std::max(first_centered_from(block.row_begin, octave.scale, octave.first_row), patch_radius);
  const int right =
      std::min(first_centered_from(block.col_end, octave.scale, octave.first_col), octave.gray.cols - patch_radius);
  const int bottom =
      std::min(first_centered_from(block.row_end, octave.scale, octave.first_row), octave.gray.rows - patch_radius);
  if (right <= left || bottom <= top) return {};
  return {left, top, right - left, bottom - top};
}

/// Where a whole patch of valid pixels lies around the pixel; empty when that is everywhere.
cv::Mat allowed_pixels(const cv::Mat& valid, int patch_radius) {
  if (cv::countNonZero(valid) == valid.rows * valid.cols) return {};
  const int side = 2 * patch_radius + 1;
  cv::Mat allowed;
  cv::erode(valid, allowed, cv::getStructuringElement(cv::MORPH_RECT, {side, side}));
  return allowed;
}

void append_octave_features(const Octave& octave, int index, const ImageBlock& block, const FeatureOptions& options,
                            FeatureSet& set) {
  const BinaryDescriptor& descriptor = descriptor_of(options);
  const int patch_radius = descriptor.reach_px;
  const cv::Rect area = feature_area(octave, block, patch_radius);
  if (area.empty()) return;
  const auto corners =
      find_corners(octave.gray, allowed_pixels(octave.valid, patch_radius), area,
                   {corners_per_octave_px(options), options.fast_threshold, options.min_fast_threshold});
  for (const Corner& corner : corners) {
    set.features.push_back({static_cast<float>((static_cast<double>(octave.first_col + corner.x) + 0.5) * octave.scale),
                            static_cast<float>((static_cast<double>(octave.first_row + corner.y) + 0.5) * octave.scale),
                            index, corner.response});
  }
  const auto descriptors = describe_corners(octave.gray, corners, descriptor);
  set.descriptors.insert(set.descriptors.end(), descriptors.begin(), descriptors.end());
}

FeatureSet empty_set(const FeatureOptions& options) {
  FeatureSet set;
  set.pattern = options.pattern;
  set.descriptor_bytes = options.descriptor_bits / 8;
  return set;
}

FeatureSet extract_from_block(const ImageBlock& block, const FeatureOptions& options) {
  FeatureSet set = empty_set(options);
  for (int index = 0; index < options.octaves; ++index) {
    const Octave octave =
        make_octave(block.gray, block.valid, block.first_col, block.first_row, octave_scale(options, index));
    append_octave_features(octave, index, block, options, set);
  }
  return set;
}

/// Windows cut to the grid; empty ones are left out.
std::vector<PixelWindow> cut_windows(const GraySource& source, const std::vector<PixelWindow>& windows) {
  std::vector<PixelWindow> result;
  for (const PixelWindow& window : windows) {
    if (window.width < 0 || window.height < 0) {
      throw UsageError("a window of " + std::to_string(window.width) + " px x " + std::to_string(window.height) +
                       " px has a negative size");
    }
    const std::int64_t col = std::clamp<std::int64_t>(window.col, 0, source.width_px);
    const std::int64_t row = std::clamp<std::int64_t>(window.row, 0, source.height_px);
    const std::int64_t col_end = std::clamp<std::int64_t>(window.col + window.width, col, source.width_px);
    const std::int64_t row_end = std::clamp<std::int64_t>(window.row + window.height, row, source.height_px);
    if (col_end > col && row_end > row) {
      result.push_back({col, row, static_cast<int>(col_end - col), static_cast<int>(row_end - row)});
    }
  }
  return result;
}

/// A block of the fixed layout and the windows that touch it.
struct MapBlock {
  std::int64_t row = 0;  ///< In blocks.
  std::int64_t col = 0;
  std::vector<std::size_t> windows;
};

std::vector<MapBlock> touched_blocks(const std::vector<PixelWindow>& windows) {
  struct Touch {
    std::int64_t row;
    std::int64_t col;
    std::size_t window;
    auto operator<=>(const Touch&) const = default;  // NOLINT(modernize-use-nullptr): takes its zero for a pointer
  };
  std::vector<Touch> touches;
  for (std::size_t i = 0; i < windows.size(); ++i) {
    const PixelWindow& w = windows[i];
    for (std::int64_t row = w.row / kFeatureBlockPx; row <= (w.row + w.height - 1) / kFeatureBlockPx; ++row) {
      for (std::int64_t col = w.col / kFeatureBlockPx; col <= (w.col + w.width - 1) / kFeatureBlockPx; ++col) {
        touches.push_back({row, col, i});
      }
    }
  }
  std::sort(touches.begin(), touches.end());
  std::vector<MapBlock> blocks;
  for (const Touch& touch : touches) {
    if (blocks.empty() || blocks.back().row != touch.row || blocks.back().col != touch.col) {
      blocks.push_back({touch.row, touch.col, {}});
    }
    blocks.back().windows.push_back(touch.window);
  }
  return blocks;
}

/// Reads a block with the margin that its features' patches need at the coarsest octave.
ImageBlock read_block(const GraySource& source, const MapBlock& block, const FeatureOptions& options) {
  const double coarsest = octave_scale(options, options.octaves - 1);
  const auto margin = static_cast<std::int64_t>(std::ceil((descriptor_of(options).reach_px + 2) * coarsest));
  const std::int64_t col = block.col * kFeatureBlockPx;
  const std::int64_t row = block.row * kFeatureBlockPx;
  const std::int64_t col_end = std::min(col + kFeatureBlockPx, source.width_px);
  const std::int64_t row_end = std::min(row + kFeatureBlockPx, source.height_px);
  const std::int64_t read_col = std::max<std::int64_t>(0, col - margin);
  const std::int64_t read_row = std::max<std::int64_t>(0, row - margin);
  const Raster raster =
      source.read({read_col, read_row, static_cast<int>(std::min(col_end + margin, source.width_px) - read_col),
                   static_cast<int>(std::min(row_end + margin, source.height_px) - read_row)});
  if (raster.pixels.type() != CV_8UC1) throw UsageError("features need a gray source of 8 bits");
  return {raster.pixels,
          raster.valid,
          read_col,
          read_row,
          static_cast<double>(col),
          static_cast<double>(col_end),
          static_cast<double>(row),
          static_cast<double>(row_end)};
}

/// The features inside at least one of the block's windows.
FeatureSet inside_windows(const FeatureSet& set, const MapBlock& block, const std::vector<PixelWindow>& windows) {
  const std::int64_t first_col = block.col * kFeatureBlockPx;
  const std::int64_t first_row = block.row * kFeatureBlockPx;
  cv::Mat wanted = cv::Mat::zeros(kFeatureBlockPx, kFeatureBlockPx, CV_8UC1);
  const cv::Rect all(0, 0, kFeatureBlockPx, kFeatureBlockPx);
  for (const std::size_t index : block.windows) {
    const PixelWindow& w = windows[index];
    const auto left = static_cast<int>(std::max<std::int64_t>(w.col - first_col, 0));
    const auto top = static_cast<int>(std::max<std::int64_t>(w.row - first_row, 0));
    const auto right = static_cast<int>(std::min<std::int64_t>(w.col + w.width - first_col, kFeatureBlockPx));
    const auto bottom = static_cast<int>(std::min<std::int64_t>(w.row + w.height - first_row, kFeatureBlockPx));
    wanted(cv::Rect(left, top, right - left, bottom - top) & all).setTo(255);
  }
  FeatureSet result;
  result.pattern = set.pattern;
  result.descriptor_bytes = set.descriptor_bytes;
  for (std::size_t i = 0; i < set.size(); ++i) {
    const Feature& feature = set.features[i];
    const auto col = static_cast<int>(std::floor(feature.x_px) - static_cast<float>(first_col));
    const auto row = static_cast<int>(std::floor(feature.y_px) - static_cast<float>(first_row));
    if (!all.contains({col, row}) || wanted.at<std::uint8_t>(row, col) == 0) continue;
    result.features.push_back(feature);
    result.descriptors.insert(result.descriptors.end(), set.descriptor(i), set.descriptor(i) + set.descriptor_bytes);
  }
  return result;
}

}  // namespace

FeatureSet extract_features_of_map(const GraySource& source, const std::vector<PixelWindow>& windows,
                                   const FeatureOptions& options, int threads, const Progress& progress) {
  check_feature_options(options);
  if (source.depth != CV_8U) throw UsageError("features need a gray source of 8 bits");
  const std::vector<PixelWindow> wanted = cut_windows(source, windows);
  const std::vector<MapBlock> blocks = touched_blocks(wanted);
  // Down one slab, then the next, so that rows of blocks that share their margins are read soon after each other.
  std::vector<std::size_t> order(blocks.size());
  std::iota(order.begin(), order.end(), 0U);
  const std::int64_t slab_px = slab_width_px(source.width_px, source.block_width_px);
  const auto slab_of = [&](std::size_t index) { return blocks[index].col * kFeatureBlockPx / slab_px; };
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return slab_of(a) < slab_of(b); });
  std::vector<FeatureSet> sets(blocks.size());
  std::mutex mutex;
  std::int64_t done = 0;
  parallel_for(blocks.size(), threads, [&](std::size_t place, int) {
    const std::size_t index = order[place];
    const FeatureSet set = extract_from_block(read_block(source, blocks[index], options), options);
    sets[index] = inside_windows(set, blocks[index], wanted);
    const std::lock_guard lock(mutex);
    report_progress(progress, "features", ++done, static_cast<std::int64_t>(blocks.size()));
  });

  FeatureSet result = empty_set(options);
  for (FeatureSet& set : sets) {
    result.features.insert(result.features.end(), set.features.begin(), set.features.end());
    result.descriptors.insert(result.descriptors.end(), set.descriptors.begin(), set.descriptors.end());
    set = {};
  }
  return result;
}

}  // namespace pilotage
