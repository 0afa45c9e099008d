#pragma once

#include <limits>
#include <vector>

#include "pilotage/ground/reason_code.h"

#pragma GCC visibility push(default)

namespace pilotage {

/// The numbers of a correlation surface (docs/methods/uniqueness.md). NaN where the surface is not defined (flat tile,
/// too little valid ground, no room to search).
struct SurfaceScores {
  double peak = std::numeric_limits<double>::quiet_NaN();         ///< R1: NCC at the true position, −1 … 1.
  double rival = std::numeric_limits<double>::quiet_NaN();        ///< R2: highest NCC outside the main lobe.
  double margin = std::numeric_limits<double>::quiet_NaN();       ///< R1 − R2; negative when a rival wins.
  double rival_ratio = std::numeric_limits<double>::quiet_NaN();  ///< R2 / R1.
  double psr = std::numeric_limits<double>::quiet_NaN();  ///< Peak-to-sidelobe ratio, (R1 − mean) / σ outside the lobe.
  double rivals = std::numeric_limits<double>::quiet_NaN();  ///< Number of local maxima above 0.8 R1 outside the lobe.
  double half_width_px = std::numeric_limits<double>::quiet_NaN();      ///< Half width at half height of the main lobe.
  double expected_error_px = std::numeric_limits<double>::quiet_NaN();  ///< σ of the fix from curvature and noise.
  double rival_dx_px = std::numeric_limits<double>::quiet_NaN();        ///< Where the rival lies, columns to the right.
  double rival_dy_px = std::numeric_limits<double>::quiet_NaN();        ///< Where the rival lies, rows down.
};

/// What a second date of the reference says of a tile (docs/methods/registration.md): measured, where `degraded` is
/// predicted. NaN without a second date, and where it has too little ground or could not be brought onto the reference.
struct EpochScores {
  double ncc = std::numeric_limits<double>::quiet_NaN();  ///< Of the tile with the registered second date, −1 … 1.
  double margin = std::numeric_limits<double>::quiet_NaN();    ///< ncc − NCC of the best wrong place; < 0: it wins.
  double survival = std::numeric_limits<double>::quiet_NaN();  ///< Share of descriptors found in both, 0 … 1.
  /// Distance between the georeferences of both dates at the tile's centre.
  double disagreement_m = std::numeric_limits<double>::quiet_NaN();
};

enum class TileStatus {
  kScored,
  kTooLittleGround,  ///< valid_fraction below the stated minimum.
  kFlat,             ///< All valid pixels have the same gray value.
};

/// The scores of one tile: numbers alone; which tile they are of is told by their place beside the tiles of a Ground
/// (score_table.h). What was not asked for, or is not defined, is NaN.
struct TileScores {
  TileStatus status = TileStatus::kScored;
  double valid_fraction = 0;
  double gray_variance = std::numeric_limits<double>::quiet_NaN();    ///< Eq. 1: V, gray levels (with the square root).
  double frieden_entropy = std::numeric_limits<double>::quiet_NaN();  ///< Eq. 2–3: H.
  double frieden_deficit = std::numeric_limits<double>::quiet_NaN();  ///< N (1 − H/e) − 1 ≈ (σ/f̄)².
  /// The probability that a frame taken here is matched and the fix is right, 0 … 1; NaN without a model.
  double p_correct_fix = std::numeric_limits<double>::quiet_NaN();
  /// Standard deviation of the place's level, logits, over which p_correct_fix is a mean: all tiles of a flight are off
  /// by the same multiple of it (place_level.h). 0: the level is known; NaN: nothing is known of it.
  double level_sigma = std::numeric_limits<double>::quiet_NaN();
  /// Tiles of this ground whose outcome on another date the level rests on (`calibrate --adapt`); 0: on other places.
  double level_tiles = std::numeric_limits<double>::quiet_NaN();
  /// Months between imagery and flight that p_correct_fix counts (matchability/level_at_age.h); NaN where it counts
  /// none: then it holds for no age more than for another.
  double level_age_months = std::numeric_limits<double>::quiet_NaN();
  /// The map's features in the tile, and the noise of the votes that they must win against
  /// (docs/methods/matchability.md).
  double map_features = std::numeric_limits<double>::quiet_NaN();
  double vote_noise = std::numeric_limits<double>::quiet_NaN();
  /// The tile's fine contrast over what ground of this imagery usually has (matchability/fine_contrast.h).
  double fine_contrast = std::numeric_limits<double>::quiet_NaN();
  /// What the ground is made of and which way its edges run (matchability/ground_cover.h).
  double vegetation_share = std::numeric_limits<double>::quiet_NaN();
  double water_share = std::numeric_limits<double>::quiet_NaN();
  double aperture = std::numeric_limits<double>::quiet_NaN();
  /// Highest minus lowest ground of the tile; NaN without an elevation model.
  double relief_m = std::numeric_limits<double>::quiet_NaN();
  SurfaceScores clean;
  SurfaceScores degraded;  ///< Mean over the degraded copies (rival position: of the copy with the smallest margin).
  EpochScores epoch;
  std::vector<ReasonCode> reasons;  ///< Why P is low, or may be, the strongest first (matchability/reasons.h).
};

/// R1 − R2 by which a tile is judged: of degraded copies, else of the clean surface, else NaN.
double judged_margin(const TileScores& score);

}  // namespace pilotage

#pragma GCC visibility pop
