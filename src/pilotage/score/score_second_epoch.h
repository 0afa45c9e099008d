#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "pilotage/base/progress.h"
#include "pilotage/ground/ground.h"
#include "pilotage/ground/tile_scores.h"
#include "pilotage/registration/register_dates.h"
#include "pilotage/score/score_tiles.h"

#pragma GCC visibility push(default)

namespace pilotage {

/// A second date beside the reference: where it disagrees.
struct SecondEpoch {
  Registration registration;
  Bounds area_m;  ///< That was looked at, in the CRS of the ground.
};

/// What bringing it onto the reference took for granted, a sentence for who judges by it.
std::string second_date_assumption(const SecondEpoch& epoch, const RegistrationOptions& options);

/// What the second date, drawn onto the reference by `field`, says of tiles of a level, named by their index in its
/// matrix. `dates` is on the grid of the matrix: north-up, square pixels, metres.
///  - ncc: the second date's tile correlated with the reference at its place, the highest within kEpochPlace_px of it;
///  - margin: ncc minus the best rival's in the tile's search area, with the second date's tile as query
///    (correlation_peaks.h; masked correlation where ground is missing);
///  - survival: the share of the reference's upright features (features.h, default options) inside the tile that
///    survive (surviving_features.h), over those where the second date has ground;
///  - disagreement_m: length of the field's displacement at the tile's centre.
/// NaN where the field is not known, where less than `min_valid_fraction` of the tile is ground in either date, for
/// flat tiles; margin also with radius 0 or when nothing lies outside the main lobe; survival for tiles without
/// features. Streams both dates; memory does not grow with the height of the grid. The same for any number of threads.
/// Throws what the sources throw; Interrupted.
std::vector<EpochScores> score_epoch_tiles(const DatePair& dates, const WarpField& field, const GridLevel& level,
                                           std::span<const std::int64_t> tile_indices, double min_valid_fraction,
                                           int threads = 0, const Progress& progress = {});

/// How far from the registered place the tile may be found, columns and rows.
inline constexpr int kEpochPlace_px = 2;

/// Registers options.second_epoch to the ground's imagery over all its tiles. Throws UsageError when the grid of a
/// level is not north-up with square pixels in metres, DataError as register_dates and inspect_imagery.
SecondEpoch register_second_epoch(const Ground& ground, const ScoreOptions& options, int threads = 0,
                                  const Progress& progress = {});

/// Scores the ground's tiles by the registration's field, which may be that of a larger ground. Throws as
/// score_epoch_tiles.
std::vector<EpochScores> score_epochs(const Ground& ground, const WarpField& field, const ScoreOptions& options,
                                      int threads = 0, const Progress& progress = {});

}  // namespace pilotage

#pragma GCC visibility pop
