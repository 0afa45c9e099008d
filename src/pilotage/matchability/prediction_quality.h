#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "pilotage/base/statistics.h"

namespace pilotage {

/// A number that was given before, what came of it, and the piece of ground it belongs to.
struct JudgedPrediction {
  double value = 0;  ///< Higher = a correct fix is more likely. For a probability 0 … 1.
  bool correct = false;
  std::int64_t block = 0;  ///< Predictions of one block are not independent of each other.
};

/// A measured number with its interval by the block bootstrap; NaN where it is not defined.
struct Estimate {
  double value = std::numeric_limits<double>::quiet_NaN();
  Interval interval{std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::quiet_NaN()};
};

/// Predictions of neighbouring value, and how many of them came true.
struct ReliabilityBin {
  double low = 0;         ///< Smallest value.
  double high = 0;        ///< Largest value.
  double mean_value = 0;  ///< What was promised, where the value is a probability.
  Share correct;          ///< Its interval: as if the outcomes were independent.
};

struct QualityOptions {
  int bins = 10;         ///< Of equal count, for reliability and calibration error; at least 1.
  int resamples = 1000;  ///< Of the bootstrap; 0 for no intervals.
  double confidence = 0.95;
  double stated_rate = std::numeric_limits<double>::quiet_NaN();  ///< A rate known beforehand, 0 … 1; NaN for none.
  std::uint64_t seed = 1;
  int threads = 0;
};

/// What predictions are worth.
struct PredictionQuality {
  std::int64_t count = 0;  ///< Predictions judged.
  std::int64_t correct = 0;
  std::int64_t undefined = 0;  ///< Left out: their value is NaN.
  std::int64_t blocks = 0;     ///< Blocks that the judged ones lie in.
  bool probability = false;    ///< The five from brier to log_score are defined for probabilities only.
  double base_rate = std::numeric_limits<double>::quiet_NaN();  ///< correct / count.

  /// The probability that a prediction that came true has a higher value than one that did not, ties counted half: the
  /// area under the ROC curve (J. A. Hanley, B. J. McNeil, Radiology 143, 1982), Mann and Whitney's U / (n₁ n₀). 0.5 is
  /// worthless; below 0.5 the value points the wrong way, and it is not turned round. NaN unless both outcomes occur.
  Estimate auc;
  /// Mean of (p − outcome)² (G. W. Brier, Mon. Weather Rev. 78, 1950): 0 is perfect, r (1 − r) what always saying the
  /// base rate r earns.
  Estimate brier;
  /// 1 − brier / (that of always saying base_rate): 1 is perfect, 0 no better than that, below 0 worse. NaN when the
  /// base rate is never wrong.
  Estimate brier_skill;
  Estimate brier_skill_stated;  ///< Against always saying QualityOptions::stated_rate.
  /// Expected calibration error: mean of |mean value − rate| of the bins, weighted by their count (M. P. Naeini, G. F.
  /// Cooper, M. Hauskrecht, AAAI 2015; equal-count bins as V. Nguyen, B. O'Connor, EMNLP 2015). Never 0 for few
  /// predictions, however good these are.
  Estimate calibration_error;
  /// What calibration_error is on average when every probability is true and outcomes are independent: in a bin of n,
  /// |mean value − rate| is nearly half-normal with variance Σ p (1 − p) / n², its mean √(2/π) of the standard
  /// deviation. Outcomes of neighbouring tiles depend on each other, so that chance gives rather more.
  double chance_calibration_error = std::numeric_limits<double>::quiet_NaN();
  /// Mean of −ln(probability given to what happened), in nats; probabilities are taken as within [1e-6, 1 − 1e-6], so
  /// that one certain mistake costs 13.8 and not infinity.
  Estimate log_score;
  /// At most QualityOptions::bins bins of as equal a count as equal values allow: these are never parted, so that the
  /// order of the predictions does not matter. Ascending, none empty.
  std::vector<ReliabilityBin> bins;
};

/// Judges predictions: all of PredictionQuality. Intervals are percentiles over resamples in which whole blocks are
/// drawn with replacement, as many as there are (B. Efron, R. J. Tibshirani, "An Introduction to the Bootstrap", 1993,
/// 13.3; blocks because neighbouring tiles share ground and fate: A. C. Davison, D. V. Hinkley, "Bootstrap Methods and
/// their Application", 1997, 8.2.3). A resample in which a number is not defined (no failure in it, say) does not count
/// for that number. Brier skill is taken against the resample's own base rate. Few blocks make intervals too narrow:
/// below about 20 they are a hint; with a single block there is none. The same for any number of threads.
///
/// Throws UsageError when a probability lies outside [0, 1], a value is infinite, or an option is out of its range.
PredictionQuality judge_predictions(std::span<const JudgedPrediction> predictions, bool probability,
                                    const QualityOptions& options = {});

}  // namespace pilotage
