#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "pilotage/base/options.h"
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

/// What the model looks at, of one tile (docs/methods/matchability.md).
struct MatchabilityInputs {
  /// ln((n + 2) / (noise + 0.3)): n features vote for the right place, and must exceed the noise of their own votes.
  double vote_contrast = 0;
  /// ln(σ/f̄ + 0.01) of the gray values: what haze, season and shadows leave of the picture.
  double gray_contrast = 0;
  /// ln of the pixels of the frame at which descriptors can be taken: the tile without a border of
  /// kDescriptorBorder_px.
  double described_area = 0;
};

inline constexpr int kDescriptorBorder_px = 16;

/// The inputs of a scored tile of side `tile_size_px`; its gray_variance, frieden_deficit, map_features and vote_noise
/// must be there. Noise of a tile without features counts as 0. `black` is the gray value that becomes 0 in 8 bits.
MatchabilityInputs matchability_inputs(const TileScores& score, int tile_size_px, double black = 0);

/// One input's part of the sum: coefficient · (x − mean), x held to mean ± 3 spread, so that ground unlike any that the
/// model has seen cannot promise more than the outermost that it has.
struct ModelTerm {
  double coefficient = 0;
  double mean = 0;
  double spread = 1;
};

/// P = 1 / (1 + exp(−z)), z = intercept + vote term + gray term + area_coefficient · described_area.
struct MatcherModel {
  FlyingMatcher matcher = FlyingMatcher::kFeatures;
  ModelTerm vote_contrast;
  ModelTerm gray_contrast;
  double intercept = 0;
  double area_coefficient = 0;
  /// Standard deviation, over places, of what z is off by: other years between the dates, other ground. Not part of P.
  double place_sigma = 0;
};

/// Trained parameters (schemas/matchability-model.schema.json), with where they come from.
struct MatchabilityModel {
  std::string date;                  ///< When it was fitted, ISO 8601.
  std::vector<std::string> places;   ///< The imagery that the slopes were fitted on.
  std::vector<std::string> anchors;  ///< Those of them that set the level.
  std::vector<MatcherModel> matchers;
};

/// P(correct fix) of one frame over the tile by the parameters of one matcher; 0 when the tile has fewer than 20
/// features, where match() refuses.
double predict_p_correct_fix(const MatcherModel& model, const MatchabilityInputs& inputs, double map_features);

/// The same for what flies. A map with chips has all that one without has: its P is the larger of both where the model
/// has parameters for both. Throws DataError when it has none for `matcher`.
double predict_p_correct_fix(const MatchabilityModel& model, FlyingMatcher matcher, const MatchabilityInputs& inputs,
                             double map_features);

/// The model's parameters for a matcher. Throws DataError when it has none.
const MatcherModel& model_of(const MatchabilityModel& model, FlyingMatcher matcher);

/// The model that comes with the program.
const MatchabilityModel& default_matchability_model();

nlohmann::ordered_json matchability_model_to_json(const MatchabilityModel& model);

/// Strict: a missing, unknown or wrong key throws DataError naming `name` and the path.
MatchabilityModel matchability_model_from_json(const nlohmann::ordered_json& json, const std::string& name);

/// matchability_model_from_json of a file. Throws DataError.
MatchabilityModel read_matchability_model(const std::filesystem::path& path);

}  // namespace pilotage

#pragma GCC visibility pop
