#include "pilotage/registration/feature_fates.h"

#include <algorithm>
#include <cmath>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/parallel.h"
#include "pilotage/vision/feature_descriptor.h"
#include "pilotage/vision/feature_octave.h"
#include "pilotage/vision/hamming_distance.h"

namespace pilotage {
namespace {

/// A stretch of the features that lies in one block of extract_features_of_map.
struct FeatureRange {
  std::size_t begin = 0;
  std::size_t end = 0;
};

std::int64_t block_of(float position_px) {
  return static_cast<std::int64_t>(position_px) / kFeatureBlockPx;
}

std::vector<FeatureRange> ranges_by_block(const std::vector<Feature>& features) {
  std::vector<FeatureRange> ranges;
  for (std::size_t i = 0; i < features.size(); ++i) {
    const bool same = i > 0 && block_of(features[i].x_px) == block_of(features[i - 1].x_px) &&
                      block_of(features[i].y_px) == block_of(features[i - 1].y_px);
    if (!same) ranges.push_back({i, i});
    ranges.back().end = i + 1;
  }
  return ranges;
}

PixelWindow grown(const PixelWindow& window, std::int64_t margin_px, const GraySource& source) {
  const std::int64_t left = std::max<std::int64_t>(0, window.col - margin_px);
  const std::int64_t top = std::max<std::int64_t>(0, window.row - margin_px);
  const std::int64_t right = std::min(source.width_px, window.col + window.width + margin_px);
  const std::int64_t bottom = std::min(source.height_px, window.row + window.height + margin_px);
  return {left, top, static_cast<int>(right - left), static_cast<int>(bottom - top)};
}

/// The second date around one block, in one octave.
struct OctaveAround {
  Octave octave;
  cv::Mat missing;  // integral of the pixels that are not valid
};

OctaveAround octave_around(const Raster& raster, const PixelWindow& window, double scale) {
  OctaveAround ground{make_octave(raster.pixels, raster.valid, window.col, window.row, scale), {}};
  cv::integral((ground.octave.valid == 0) / 255, ground.missing, CV_32S);
  return ground;
}

/// Whether all pixels within `reach` of a pixel of the octave are there and valid.
bool shown(const OctaveAround& ground, int x, int y, int reach) {
  const cv::Rect around(x - reach, y - reach, 2 * reach + 1, 2 * reach + 1);
  if ((around & cv::Rect({0, 0}, ground.octave.gray.size())) != around) return false;
  const cv::Mat& sums = ground.missing;
  return sums.at<int>(around.br()) - sums.at<int>(around.y, around.br().x) - sums.at<int>(around.br().y, around.x) +
             sums.at<int>(around.tl()) ==
         0;
}

/// Steps in pixels to all places within a radius.
std::vector<cv::Point> steps_within(double radius_px) {
  std::vector<cv::Point> steps;
  const int most = static_cast<int>(radius_px);
  for (int y = -most; y <= most; ++y) {
    for (int x = -most; x <= most; ++x) {
      if (x * x + y * y <= radius_px * radius_px) steps.emplace_back(x, y);
    }
  }
  return steps;
}

struct Search {
  const FeatureOptions& features;
  std::vector<cv::Point> steps;
  int patch_px;
  std::uint32_t most_bits;

  double scale_of(int octave) const { return std::pow(features.scale_factor, octave); }
};

/// Where the second date is described for one feature: one place for each step, or none when one of them is not shown.
std::vector<Corner> places_around(const Feature& feature, const OctaveAround& ground, const Search& search) {
  const Octave& octave = ground.octave;
  const auto place = [&](float position_px, std::int64_t first) {
    return static_cast<int>(std::llround(static_cast<double>(position_px) / octave.scale - 0.5) - first);
  };
  const int x = place(feature.x_px, octave.first_col);
  const int y = place(feature.y_px, octave.first_row);
  std::vector<Corner> places;
  for (const cv::Point& step : search.steps) {
    if (!shown(ground, x + step.x, y + step.y, search.patch_px)) return {};
    places.push_back({x + step.x, y + step.y, 0});
  }
  return places;
}

/// Judges the features of a range that lie in one octave.
void judge_octave(const FeatureSet& reference, const FeatureRange& range, int octave, const OctaveAround& ground,
                  const Search& search, std::vector<FeatureFate>& fates) {
  std::vector<std::size_t> judged;
  std::vector<Corner> places;  // of the judged features, one after the other
  for (std::size_t i = range.begin; i < range.end; ++i) {
    if (reference.features[i].octave != octave) continue;
    const std::vector<Corner> around = places_around(reference.features[i], ground, search);
    if (around.empty()) continue;
    judged.push_back(i);
    places.insert(places.end(), around.begin(), around.end());
  }
  const auto descriptors = describe_corners(ground.octave.gray, places, descriptor_of(reference));
  const auto bytes = static_cast<std::size_t>(reference.descriptor_bytes);
  std::vector<const std::uint8_t*> candidates(search.steps.size());
  for (std::size_t k = 0; k < judged.size(); ++k) {
    for (std::size_t step = 0; step < candidates.size(); ++step) {
      candidates[step] = descriptors.data() + (k * candidates.size() + step) * bytes;
    }
    const NearestDescriptor nearest =
        nearest_descriptor(reference.descriptor(judged[k]), candidates.data(), candidates.size(), bytes);
    fates[judged[k]] = nearest.distance <= search.most_bits ? FeatureFate::kSurvives : FeatureFate::kGone;
  }
}

void judge_range(const FeatureSet& reference, const FeatureRange& range, const GraySource& second, const Search& search,
                 std::vector<FeatureFate>& fates) {
  const FeatureOptions& options = search.features;
  const Feature& any = reference.features[range.begin];
  const PixelWindow block{block_of(any.x_px) * kFeatureBlockPx, block_of(any.y_px) * kFeatureBlockPx, kFeatureBlockPx,
                          kFeatureBlockPx};
  const int reach_px = search.patch_px + 2 - search.steps.front().y;  // the first step is the farthest up
  const auto margin_px = static_cast<std::int64_t>(std::ceil(reach_px * search.scale_of(options.octaves - 1)));
  const PixelWindow window = grown(block, margin_px, second);
  const Raster raster = second.read(window);
  if (raster.pixels.type() != CV_8UC1) throw UsageError("features need a gray source of 8 bits");
  for (int octave = 0; octave < options.octaves; ++octave) {
    judge_octave(reference, range, octave, octave_around(raster, window, search.scale_of(octave)), search, fates);
  }
}

}  // namespace

std::vector<FeatureFate> feature_fates(const FeatureSet& reference, const GraySource& registered_second,
                                       const FeatureOptions& options, int threads) {
  check_feature_options(options);
  const Search search{options, steps_within(kSurvivalRadiusPx), descriptor_of(options).reach_px,
                      static_cast<std::uint32_t>(descriptor_of(reference).survival_bits())};
  std::vector<FeatureFate> fates(reference.size(), FeatureFate::kNotKnown);
  const std::vector<FeatureRange> ranges = ranges_by_block(reference.features);
  parallel_for(ranges.size(), threads,
               [&](std::size_t i, int) { judge_range(reference, ranges[i], registered_second, search, fates); });
  return fates;
}

}  // namespace pilotage
