#include "pilotage/registration/feature_fates.h"

#include <algorithm>
#include <cmath>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "pilotage/base/parallel.h"
#include "pilotage/registration/surviving_features.h"

namespace pilotage {
namespace {

/// A stretch of the features that lies in one block of extract_features_of_map.
struct Run {
  std::size_t begin = 0;
  std::size_t end = 0;
};

std::int64_t block_of(float position_px) {
  return static_cast<std::int64_t>(position_px) / kFeatureBlockPx;
}

std::vector<Run> runs_of(const std::vector<Feature>& features) {
  std::vector<Run> runs;
  for (std::size_t i = 0; i < features.size(); ++i) {
    const bool same = i > 0 && block_of(features[i].x_px) == block_of(features[i - 1].x_px) &&
                      block_of(features[i].y_px) == block_of(features[i - 1].y_px);
    if (!same) runs.push_back({i, i});
    runs.back().end = i + 1;
  }
  return runs;
}

PixelWindow grown(const PixelWindow& window, std::int64_t margin_px, const GraySource& source) {
  const std::int64_t left = std::max<std::int64_t>(0, window.col - margin_px);
  const std::int64_t top = std::max<std::int64_t>(0, window.row - margin_px);
  const std::int64_t right = std::min(source.width_px, window.col + window.width + margin_px);
  const std::int64_t bottom = std::min(source.height_px, window.row + window.height + margin_px);
  return {left, top, static_cast<int>(right - left), static_cast<int>(bottom - top)};
}

/// Pixels around a feature on which a counterpart within the radius of survival may depend.
std::int64_t reach_px(const Feature& feature, const FeatureOptions& options) {
  const double pixel = std::pow(options.scale_factor, feature.octave);
  return static_cast<std::int64_t>(std::ceil((patch_radius_px(options) + 1) * pixel + SurvivalOptions{}.radius_px));
}

/// Marks the features of one block around which the second date does not show everything.
void mark_not_known(const std::vector<Feature>& features, const Run& run, const GraySource& second,
                    const FeatureOptions& options, std::vector<FeatureFate>& fates) {
  std::int64_t widest_px = 0;
  for (std::size_t i = run.begin; i < run.end; ++i) widest_px = std::max(widest_px, reach_px(features[i], options));
  const PixelWindow block{block_of(features[run.begin].x_px) * kFeatureBlockPx,
                          block_of(features[run.begin].y_px) * kFeatureBlockPx, kFeatureBlockPx, kFeatureBlockPx};
  const PixelWindow window = grown(block, widest_px, second);
  cv::Mat missing;
  cv::integral((second.read(window).valid == 0) / 255, missing, CV_32S);
  for (std::size_t i = run.begin; i < run.end; ++i) {
    const std::int64_t reach = reach_px(features[i], options);
    const PixelWindow pixel{static_cast<std::int64_t>(features[i].x_px), static_cast<std::int64_t>(features[i].y_px), 1,
                            1};
    const PixelWindow around = grown(pixel, reach, second);
    const auto left = static_cast<int>(around.col - window.col);
    const auto top = static_cast<int>(around.row - window.row);
    const int sum = missing.at<int>(top + around.height, left + around.width) -
                    missing.at<int>(top, left + around.width) - missing.at<int>(top + around.height, left) +
                    missing.at<int>(top, left);
    if (sum != 0) fates[i] = FeatureFate::kNotKnown;
  }
}

}  // namespace

std::vector<FeatureFate> feature_fates(const FeatureSet& reference, const std::vector<PixelWindow>& windows,
                                       const GraySource& registered_second, const FeatureOptions& options,
                                       int threads) {
  std::vector<PixelWindow> around;  // a feature at the edge may have its counterpart just beyond
  const auto radius_px = static_cast<std::int64_t>(std::ceil(SurvivalOptions{}.radius_px));
  for (const PixelWindow& window : windows) around.push_back(grown(window, radius_px, registered_second));
  const FeatureSet second = extract_features_of_map(registered_second, around, options, threads);
  std::vector<FeatureFate> fates;
  for (const std::uint8_t survives : surviving_features(reference, second)) {
    fates.push_back(survives != 0 ? FeatureFate::kSurvives : FeatureFate::kGone);
  }
  const std::vector<Run> runs = runs_of(reference.features);
  parallel_for(runs.size(), threads, [&](std::size_t i, int) {
    mark_not_known(reference.features, runs[i], registered_second, options, fates);
  });
  return fates;
}

}  // namespace pilotage
