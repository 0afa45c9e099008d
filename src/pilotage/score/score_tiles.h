#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "pilotage/base/options.h"
#include "pilotage/base/progress.h"
#include "pilotage/degradation/degradation.h"
#include "pilotage/geo/tile_matrix.h"
#include "pilotage/ground/tile_scores.h"
#include "pilotage/matchability/matchability_model.h"
#include "pilotage/raster/gray_source.h"
#include "pilotage/registration/registration_options.h"
#include "pilotage/vision/features.h"

#pragma GCC visibility push(default)

namespace pilotage {

/// What is measured of a tile.
enum class ScoreMeasure {
  kGrayVariance,    ///< Eq. 1: V.
  kFriedenEntropy,  ///< Eq. 2–3: H and the Frieden deficit.
  kUniqueness,      ///< The correlation surface of the tile in its search area.
  kDegraded,        ///< The same for degraded copies of the tile.
  kGroundCover,  ///< Vegetation, water, direction of edges; of a plan also relief. Not measured by score_tiles, which
                 ///< sees no colours.
  kCorrectFix,   ///< P(correct fix) and what it is made of; V, H and the deficit are then measured too.
};

inline EnumNames<ScoreMeasure> enum_names(ScoreMeasure) {
  return {{ScoreMeasure::kGrayVariance, "gray_variance"}, {ScoreMeasure::kFriedenEntropy, "frieden_entropy"},
          {ScoreMeasure::kUniqueness, "uniqueness"},      {ScoreMeasure::kDegraded, "degraded"},
          {ScoreMeasure::kGroundCover, "ground_cover"},   {ScoreMeasure::kCorrectFix, "correct_fix"}};
}

struct ScoreOptions {
  std::vector<ScoreMeasure> measures{ScoreMeasure::kGrayVariance, ScoreMeasure::kFriedenEntropy,
                                     ScoreMeasure::kUniqueness,   ScoreMeasure::kDegraded,
                                     ScoreMeasure::kGroundCover,  ScoreMeasure::kCorrectFix};
  double min_valid_fraction = 0.5;
  FlyingMatcher matcher = FlyingMatcher::kFeatures;
  std::string model;
  std::optional<double> usual_fine_contrast;
  int degraded_copies = 2;
  bool every_lag = false;
  DegradationOptions degradation;
  FeatureOptions features;  ///< Of the map that will be built; no option of `score`, `prepare` sets it.
  /// Of the imagery at the flight (imagery_months); no option: score_ground takes it from the ground.
  std::optional<double> imagery_months;
  std::vector<std::string> second_epoch;  ///< Not looked at by score_tiles: see score_second_epoch.h.
  RegistrationOptions registration;

  template <class Self, class Fields>
  static void describe(Self& self, Fields& fields) {
    fields.field("measures", self.measures, "What is measured of each tile.");
    fields.field(
        "min_valid_fraction", self.min_valid_fraction,
        "Tiles with a smaller share of ground are not scored; positions that overlap less of the tile's ground "
        "are no rivals.",
        Range{0.01, 1});
    fields.field("matcher", self.matcher, "What flies, for P(correct fix): a map with or without chips.");
    fields.path("model", self.model, "Parameters of P(correct fix), as `pilotage calibrate` writes them.");
    fields.field(
        "usual_fine_contrast", self.usual_fine_contrast,
        "Fine contrast that ground usually has, in gray levels, which P(correct fix) holds that of a tile "
        "against; measured over the grid if not given, so that P of a place changes a little with the corridor. "
        "The page of a survey gives its own to the missions that are sketched on it.",
        Range{0.01, 255});
    fields.field("degraded_copies", self.degraded_copies, "Degraded copies per tile; scores are their mean.",
                 Range{1, 64});
    fields.field("every_lag", self.every_lag,
                 "Clean surfaces at every lag, not at a lattice of them with the rivals looked at more closely: about "
                 "half as fast.");
    fields.group("degradation", self.degradation, "How the degraded copies differ from the reference.");
    fields.path(
        "second_epoch", self.second_epoch,
        "Imagery of the same ground at another date: it is brought onto the reference, the disagreement of both "
        "georeferences is reported, and each tile is measured against it.");
    fields.group("registration", self.registration, "How the second date is brought onto the reference.");
  }

  bool measures_surface() const;
  bool measure(ScoreMeasure which) const;
};

/// Scores tiles of `matrix`, whose pixel grid is that of `source`. Result i belongs to `tile_indices[i]`, where index =
/// row · matrix_width + column; indices ascend. Tile size and stride are the matrix's.
///
/// What is defined for special tiles:
///  - valid fraction below min_valid_fraction: status kTooLittleGround, all measures NaN;
///  - all valid pixels equal: kFlat, V = 0, H and deficit as the formulas say, surface scores NaN;
///  - partly covered tile or search area: V and H over the valid pixels, surfaces by masked correlation
///  (fft_correlation.h),
///    positions with too little overlap excluded;
///  - the search area is cut at the edge of the grid.
///
/// Streams `source` in blocks of columns and rows, each pixel read about once; memory stays below 2 GiB with the
/// default options and grows with the number of tiles alone, whatever the width and the height of the grid; of imagery
/// in strips with its width. Deterministic: the same bytes for any `threads` and any choice of tiles that holds a given
/// tile.
///
/// Throws UsageError when an option or an index is out of range, an index does not follow the one before it, no measure
/// is asked for, or a surface is asked for with radius 0;
/// DataError when the tile is larger than the grid, the matrix is not that of the source, or reading fails;
/// Interrupted.
std::vector<TileScores> score_tiles(const GraySource& source, const TileMatrix& matrix, int search_radius_px,
                                    std::span<const std::int64_t> tile_indices, const ScoreOptions& options,
                                    std::uint64_t seed = 1, int threads = 0, const Progress& progress = {});

}  // namespace pilotage

#pragma GCC visibility pop
