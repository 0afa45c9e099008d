#include "pilotage/build_map/stable_features.h"

#include <algorithm>
#include <memory>
#include <numeric>

#include "pilotage/ground/ground_imagery.h"
#include "pilotage/raster/gdal_gray.h"
#include "pilotage/raster/gray_stretch.h"
#include "pilotage/registration/register_tiles.h"
#include "pilotage/registration/warped_source.h"

namespace pilotage {

SecondDate register_second_date(const Ground& ground, const std::vector<std::string>& datasets,
                                const RegistrationOptions& options, int threads, const Progress& progress) {
  std::vector<Bounds> tiles;
  for (const GroundTile& tile : ground.tiles) tiles.push_back(tile.bounds);
  const TileRegistration registered = register_tiles(dataset_names(ground.imagery), ground.imagery.options, datasets,
                                                     ground.crs, tiles, options, threads, progress);
  return {datasets, registered.registration.fit.field};
}

GraySource open_second_date(const SecondDate& second, const Ground& ground, const GridLevel& level) {
  const GraySource as_delivered =
      open_gray_on_grid(second.datasets, ground.crs, level.matrix.map_from_pixel, level.matrix.grid_width_px,
                        level.matrix.grid_height_px, second_date_options(ground.imagery.options));
  return warped_source(stretch_to_8bit(as_delivered), std::make_shared<const WarpField>(second.field));
}

void WindowCounts::add(double x_px, double y_px) {
  const auto x = static_cast<std::int64_t>(x_px);
  const auto y = static_cast<std::int64_t>(y_px);
  const auto first = [&](std::int64_t position) {
    const std::int64_t before = position - matrix_.tile_size_px;  // tiles that begin here or earlier end before it
    return before < 0 ? 0 : before / matrix_.stride_px + 1;
  };
  for (std::int64_t row = first(y); row * matrix_.stride_px <= y; ++row) {
    for (std::int64_t column = first(x); column * matrix_.stride_px <= x; ++column) ++counts_[{row, column}];
  }
}

std::int64_t WindowCounts::take(std::int64_t column, std::int64_t row) {
  const auto found = counts_.extract({row, column});
  return found.empty() ? 0 : found.mapped();
}

void drop_contradicted(FeatureSet& features, std::vector<float>& ground_height_m, const std::vector<FeatureFate>& fates,
                       std::int64_t kept_in_window, StableStats& stats) {
  std::vector<std::size_t> gone;
  for (std::size_t i = 0; i < fates.size(); ++i) {
    if (fates[i] == FeatureFate::kGone) gone.push_back(i);
    if (fates[i] == FeatureFate::kSurvives) ++stats.survived;
    if (fates[i] == FeatureFate::kNotKnown) ++stats.not_known;
  }
  std::stable_sort(gone.begin(), gone.end(), [&](std::size_t a, std::size_t b) {
    return features.features[a].response > features.features[b].response;
  });
  const std::int64_t missing = std::max<std::int64_t>(0, kLeastFeatures - kept_in_window);
  const std::size_t refill = std::min(gone.size(), static_cast<std::size_t>(missing));
  stats.refilled += static_cast<std::int64_t>(refill);
  stats.tiles_refilled += refill > 0 ? 1 : 0;
  stats.dropped += static_cast<std::int64_t>(gone.size() - refill);
  std::vector<std::uint8_t> keep(fates.size(), 1);
  for (std::size_t i = refill; i < gone.size(); ++i) keep[gone[i]] = 0;

  FeatureSet kept;
  kept.pattern = features.pattern;
  kept.descriptor_bytes = features.descriptor_bytes;
  std::vector<float> heights;
  for (std::size_t i = 0; i < fates.size(); ++i) {
    if (keep[i] == 0) continue;
    kept.features.push_back(features.features[i]);
    kept.descriptors.insert(kept.descriptors.end(), features.descriptor(i),
                            features.descriptor(i) + features.descriptor_bytes);
    if (!ground_height_m.empty()) heights.push_back(ground_height_m[i]);
  }
  features = std::move(kept);
  ground_height_m = std::move(heights);
}

}  // namespace pilotage
