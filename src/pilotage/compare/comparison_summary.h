#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "pilotage/base/statistics.h"
#include "pilotage/compare/compare.h"

namespace pilotage {

/// Median of the frames, and their sum.
struct Times {
  double median_ms = 0;
  double sum_ms = 0;
};

/// One method over all frames. Times and numbers of features leave out frames with a problem.
struct MethodSummary {
  DescriptorMethod method = DescriptorMethod::kOrb;
  Times detect;
  Times describe;
  Times match;
  Times total;                ///< The three, for each frame.
  Times reference;            ///< Features of the reference.
  double frame_features = 0;  ///< Median.
  double reference_features = 0;
  Share best;     ///< Of kBestMatches for each frame that shows the reference; a match that is missing counts as wrong.
  Share matches;  ///< Of all nearest neighbours of such frames: those that agree with the truth.
  Share inliers;  ///< Of the matches of such frames that passed the ratio test: those that agree with the transform.
  Share correct;  ///< Of the frames that show the reference: those with a correct fix.
  Share wrong;    ///< Of all frames: those with an accepted fix that is not correct.
  Share wrong_of_accepted;  ///< Of the accepted fixes.
};

/// In the order of Comparison::methods.
std::vector<MethodSummary> summarise(const Comparison& comparison);

/// A number of a summary. CSV and JSON have these columns, after "method"; NaN is an empty cell or null.
struct SummaryColumn {
  std::string name;
  std::string help;
  std::function<double(const MethodSummary&)> get;
};
const std::vector<SummaryColumn>& summary_columns();

}  // namespace pilotage
