#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "pilotage/matchability/matchability_model.h"

namespace pilotage {

/// One judged frame.
struct FitSample {
  MatchabilityInputs inputs;
  bool correct = false;
};

/// The judged frames of one place, all of one size on the ground.
struct FitSet {
  std::string place;
  bool anchor = false;  ///< Its share of correct fixes is one that flights can expect.
  std::vector<FitSample> samples;
};

/// An input that a model is to look at, and how many spreads above its mean it may still raise P (ModelTerm::most).
struct TermChoice {
  ModelInput input = ModelInput::kMapFeatures;
  double most = 3;
};

/// Those of the default model (docs/methods/matchability.md).
std::vector<TermChoice> default_terms();

/// What ground that repeats itself costs: 6 ln(c / 30) where the vote contrast c = (n + 2) / (noise + 0.3) is below 30,
/// else nothing. Every fitted model has it, and it is **not fitted**: orchards and roofs in rows hardly occur where
/// there is imagery of two dates. A tenth to a quarter of the features of a map are found again on another date, and
/// the highest of some thousand wrong places stands four times the noise of the votes out: c has to be some 30.
ModelTerm repetition_term();

/// Fits a logistic regression whose intercept, the level, is drawn for each place: logit P = Σ terms + level,
/// level ~ N(μ, τ²), μ one for the anchors and one for the other places, τ one for all (A. Gelman, J. Hill, Data
/// Analysis Using Regression and Multilevel/Hierarchical Models, 2007, 12–14).
///
/// Slopes maximise the marginal likelihood: for each place the level is integrated out at 21 nodes around its mode
/// (adaptive quadrature: J. Pinheiro, D. Bates, J. Comput. Graph. Stat. 4(1), 1995; trapezoidal rule), and L-BFGS of
/// Ceres climbs its logarithm, whose gradient is the posterior mean of that of the likelihood (R. Fisher's identity).
/// A ridge of 0.3 holds slopes on standardised inputs. Tiles of a place overlap and share their fate: four count as
/// one.
///
/// With the slopes held, μ and τ have a posterior on a grid: flat in μ, half-Cauchy of scale 2.5 in τ (A. Gelman,
/// Bayesian Analysis 1(3), 2006). From it follows what the level of an anchor not among these may be; `level` is the
/// normal distribution with the same 80 % interval, so that sigma holds how places differ and how little few places
/// tell of that.
///
/// Deterministic. Throws DataError when there is no anchor, when the anchors have a single outcome, or when there are
/// fewer than 50 samples of either outcome.
MatcherModel fit_matcher_model(FlyingMatcher matcher, const std::vector<FitSet>& sets,
                               const std::vector<TermChoice>& terms = default_terms());

/// The model for one place where a second date has been judged: what is known of the level becomes its posterior (mean
/// and standard deviation on a grid; four tiles count as one). Nothing else changes. Throws DataError when there is no
/// sample.
MatcherModel adapt_level(const MatcherModel& model, const std::vector<FitSet>& sets);

/// Mean and standard deviation of a distribution.
struct LevelPosterior {
  double mean = 0;
  double sigma = 0;
};

/// Of a level that is N(mean, sigma²) before the outcomes at `logits` (Σ terms) are seen; each counts by `weight`.
LevelPosterior level_posterior(const LevelPosterior& prior, const std::vector<double>& logits,
                               const std::vector<bool>& correct, double weight);

/// Tiles that overlap succeed and fail together: so many count as one where a level is learned.
inline constexpr double kTilesThatShareGround = 4;

}  // namespace pilotage
