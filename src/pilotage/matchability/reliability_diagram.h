#pragma once

#include <string>

#include "pilotage/matchability/prediction_quality.h"

namespace pilotage {

/// The reliability diagram (A. H. Murphy, R. L. Winkler, Appl. Stat. 26, 1977) of a probability as a self-contained
/// SVG: for each bin the mean probability against the rate that came true, with the rate's 95 % interval; the diagonal,
/// where honest probabilities lie; the base rate as a level line; below it how many predictions there are in each
/// twentieth of [0, 1]; above it `title` and the numbers with their intervals. Colours follow the reader's light or
/// dark scheme. No script, no font file, nothing fetched; the same bytes for the same input. `predictions` are what
/// `quality` was made of; NaN values are left out. Throws UsageError unless quality.probability.
std::string reliability_diagram_svg(const std::string& title, const PredictionQuality& quality,
                                    std::span<const JudgedPrediction> predictions);

}  // namespace pilotage
