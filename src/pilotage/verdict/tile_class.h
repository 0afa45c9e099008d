#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "pilotage/ground/measure_scale.h"
#include "pilotage/ground/tile_scores.h"
#include "pilotage/raster/gdal_write.h"
#include "pilotage/verdict/quality.h"

namespace pilotage {

/// Whether a tile can be counted on. The numbers are the classes of the class raster.
enum class TileClass : std::uint8_t { kGo = 0, kMarginal = 1, kNoGo = 2 };

/// Where the classes part. Every map, raster and style takes them from here.
struct TileClassThresholds {
  static constexpr double kMatchableP = 0.2;  ///< As `select` counts on a tile (min_p_correct_fix).
  static constexpr double kGoodP = 0.5;       ///< A convention: found more often than not.
  static constexpr double kMatchableMargin = 0;
  static constexpr double kGoodMargin = 0.05;  ///< As `select` without a P (min_peak_margin).
};

/// By P(correct fix) where there is one: go from 0.5, marginal from 0.2, else no-go. Else by the margin of degraded
/// copies: go from 0.05, marginal above 0. A tile that could not be scored (too little ground, flat) is no-go; nothing
/// when neither was measured.
std::optional<TileClass> tile_class(const TileScores& score);

/// What the classes mean, for people: "go: P(correct fix) from 0.5, …".
std::string tile_classes_meaning();

/// Names and colours of the classes in the order of their numbers.
const std::vector<RasterClass>& tile_classes();

/// The colour in which page, maps and files show a status: blue, orange, magenta, which colour-blind people tell apart.
Rgb status_color(QualityStatus status);

}  // namespace pilotage
