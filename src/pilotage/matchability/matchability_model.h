#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "pilotage/base/options.h"
#include "pilotage/ground/ground.h"
#include "pilotage/ground/tile_scores.h"

#pragma GCC visibility push(default)

namespace pilotage {

/// What flies.
enum class FlyingMatcher {
  kFeatures,          ///< match() on a map without chips.
  kFeaturesAndChips,  ///< match() on a map with chips.
};

inline EnumNames<FlyingMatcher> enum_names(FlyingMatcher) {
  return {{FlyingMatcher::kFeatures, "features"}, {FlyingMatcher::kFeaturesAndChips, "features_and_chips"}};
}

std::string flying_matcher_name(FlyingMatcher matcher);  ///< As in files and options.

/// What the model may look at, of one tile (docs/methods/matchability.md).
enum class ModelInput {
  kMapFeatures,   ///< ln(n + 2): n features of the map vote for the right place.
  kVoteNoise,     ///< ln(noise + 0.3) of their own votes for wrong ones.
  kGrayContrast,  ///< ln(σ/f̄ + 0.01) of the gray values.
  /// ln of TileScores::fine_contrast + 0.05: how clearly corners and edges stand out, without what a sensor and its
  /// processing do to all of the imagery.
  kFineContrast,
  kVoteContrast,  ///< kMapFeatures − kVoteNoise: how far the true peak can stand above the others.
};
inline constexpr std::size_t kModelInputs = 5;

inline EnumNames<ModelInput> enum_names(ModelInput) {
  return {{ModelInput::kMapFeatures, "map_features"},
          {ModelInput::kVoteNoise, "vote_noise"},
          {ModelInput::kGrayContrast, "gray_contrast"},
          {ModelInput::kFineContrast, "fine_contrast"},
          {ModelInput::kVoteContrast, "vote_contrast"}};
}

std::string model_input_name(ModelInput input);  ///< As in files and options.

/// The value of each ModelInput.
struct MatchabilityInputs {
  std::array<double, kModelInputs> values{};

  double operator[](ModelInput input) const { return values[static_cast<std::size_t>(input)]; }
  double& operator[](ModelInput input) { return values[static_cast<std::size_t>(input)]; }
};

/// Features of the map below which match() refuses a frame, and P is 0.
inline constexpr double kLeastMapFeatures = 20;

/// The inputs of a scored tile; its frieden_deficit and map_features must be there. Noise of a tile without features
/// counts as 0, a contrast relative to nothing known as usual.
MatchabilityInputs matchability_inputs(const TileScores& score);

/// One input's part of the sum: coefficient · (x − mean) / spread, held to at most abs(coefficient) · most, so that
/// ground unlike any that the model has seen cannot promise more.
struct ModelTerm {
  ModelInput input = ModelInput::kMapFeatures;
  double coefficient = 0;
  double mean = 0;
  double spread = 1;
  double most = 3;
};

/// What is known of the level of the place that is flown over, in logits: a normal distribution. The level is what one
/// date of imagery cannot show: how much season, years and sensors take from all tiles alike.
struct PlaceLevel {
  double mean = 0;
  /// Of a place never seen: how places differ, and how little is known of that; of one that was adapted to, of its
  /// posterior.
  double sigma = 0;
  double spread = 0;  ///< Standard deviation of the levels of places (τ): the median of what is known of it,
  double spread_low = 0;
  double spread_high = 0;  ///< and its 80 % interval.
  int places = 0;          ///< Anchors that the mean rests on.
  std::int64_t tiles = 0;  ///< Tiles of this ground, judged on another date, that it rests on (adapt_level).
};

/// logit P = Σ terms + level; P of a tile is the mean over what the level may be (ground/place_level.h).
struct MatcherModel {
  FlyingMatcher matcher = FlyingMatcher::kFeatures;
  std::vector<ModelTerm> terms;
  PlaceLevel level;
};

/// Trained parameters (schemas/matchability-model.schema.json), with where they come from.
struct MatchabilityModel {
  std::string date;                  ///< When it was fitted, ISO 8601.
  std::vector<std::string> places;   ///< The imagery that the slopes were fitted on.
  std::vector<std::string> anchors;  ///< Those of them that set the level.
  std::vector<MatcherModel> matchers;
};

/// Σ terms, without the level.
double sum_of_terms(const MatcherModel& model, const MatchabilityInputs& inputs);

/// What a model says of a tile.
struct FixPrediction {
  double p = 0;  ///< Of a correct fix, over what the level of the place may be.
  double level_sigma = 0;
  std::int64_t level_tiles = 0;  ///< PlaceLevel::tiles.
};

/// P(correct fix) of one frame over the tile by the parameters of one matcher; 0 when the tile has fewer than
/// kLeastMapFeatures, where match() refuses.
FixPrediction predict_correct_fix(const MatcherModel& model, const MatchabilityInputs& inputs, double map_features);

/// The same for what flies. A map with chips has all that one without has: it has the prediction with the larger P
/// where the model has parameters for both. Throws DataError when it has none for `matcher`.
FixPrediction predict_correct_fix(const MatchabilityModel& model, FlyingMatcher matcher,
                                  const MatchabilityInputs& inputs, double map_features);

/// The model's parameters for a matcher. Throws DataError when it has none.
const MatcherModel& model_of(const MatchabilityModel& model, FlyingMatcher matcher);

/// The model that comes with the program.
const MatchabilityModel& default_matchability_model();

nlohmann::ordered_json matchability_model_to_json(const MatchabilityModel& model);

/// Strict: a missing, unknown or wrong key throws DataError naming `name` and the path; so does an
/// older format, with what to do.
MatchabilityModel matchability_model_from_json(const nlohmann::ordered_json& json, const std::string& name);

/// matchability_model_from_json of a file. Throws DataError.
MatchabilityModel read_matchability_model(const std::filesystem::path& path);

/// Whether P on this ground is about as it was tested (docs/methods/matchability.md): on frames of as many pixels, of
/// maps of about this ground sample distance.
bool is_like_tested(const GridLevel& level);

/// What it was tested on: "frames of 72 to 222 px of maps of 0.6 m/px".
std::string tested_on_text();

}  // namespace pilotage

#pragma GCC visibility pop
