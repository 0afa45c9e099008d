#include "pilotage/matchability/matchability_model.h"

#include <algorithm>
#include <cmath>

#include <nlohmann/json.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/json_object.h"
#include "pilotage/base/options_json.h"
#include "pilotage/base/output_file.h"
#include "pilotage/base/text.h"
#include "pilotage/ground/place_level.h"
#include "pilotage/matchability/default_model_bytes.h"

namespace pilotage {
namespace {

constexpr int kFormatVersion = 3;

constexpr int kSmallestTested_px = 72;
constexpr int kLargestTested_px = 222;
constexpr double kTestedGsd_m = 0.6;
constexpr double kLikeTested = 1.25;  // a convention: pixels that differ by less are called alike

using Json = nlohmann::ordered_json;

template <class Enum>
Enum value_named(const std::string& name, const std::string& path) {
  std::vector<std::string> known;
  for (const auto& entry : enum_names(Enum{})) {
    if (entry.name == name) return entry.value;
    known.emplace_back(entry.name);
  }
  throw DataError(path + " = \"" + name + "\": one of " + join(known, ", "));
}

template <class Enum>
std::string name_of_value(Enum value) {
  for (const auto& entry : enum_names(Enum{})) {
    if (entry.value == value) return std::string(entry.name);
  }
  return {};
}

Json term_to_json(const ModelTerm& term) {
  return {{"input", model_input_name(term.input)},
          {"coefficient", term.coefficient},
          {"mean", term.mean},
          {"spread", term.spread},
          {"most", term.most}};
}

ModelTerm term_from_json(JsonObject& json) {
  const auto input = value_named<ModelInput>(json.text("input"), json.path("input"));
  const ModelTerm term{input, json.number("coefficient"), json.number("mean"), json.positive_number("spread"),
                       json.number("most")};
  json.finish();
  return term;
}

Json level_to_json(const PlaceLevel& level) {
  return {{"mean", level.mean},
          {"sigma", level.sigma},
          {"spread", level.spread},
          {"spread_low", level.spread_low},
          {"spread_high", level.spread_high},
          {"places", level.places},
          {"tiles", level.tiles}};
}

PlaceLevel level_from_json(JsonObject json) {
  PlaceLevel level;
  level.mean = json.number("mean");
  level.sigma = json.positive_number("sigma");
  level.spread = json.number("spread");
  level.spread_low = json.number("spread_low");
  level.spread_high = json.number("spread_high");
  level.places = json.small_integer("places", 0, 1'000'000);
  level.tiles = json.integer("tiles", 0);
  json.finish();
  return level;
}

void refuse_older(JsonObject& file, const std::string& name) {
  if (file.integer("format_version", 0) >= kFormatVersion) return;
  throw DataError(name +
                  ": is a model of a version whose P looks at other numbers of a tile; evaluate again (`pilotage score "
                  "--evaluate`), and fit it to that with `pilotage calibrate`");
}

}  // namespace

std::string flying_matcher_name(FlyingMatcher matcher) {
  return name_of_value(matcher);
}

std::string model_input_name(ModelInput input) {
  return name_of_value(input);
}

MatchabilityInputs matchability_inputs(const TileScores& score) {
  const double noise = std::isnan(score.vote_noise) ? 0 : score.vote_noise;
  const double fine = std::isnan(score.fine_contrast) ? 1 : score.fine_contrast;
  MatchabilityInputs inputs;
  inputs[ModelInput::kMapFeatures] = std::log(score.map_features + 2);
  inputs[ModelInput::kVoteNoise] = std::log(noise + 0.3);
  inputs[ModelInput::kGrayContrast] = std::log(std::sqrt(std::max(score.frieden_deficit, 0.0)) + 0.01);
  inputs[ModelInput::kFineContrast] = std::log(fine + 0.05);
  inputs[ModelInput::kVoteContrast] = inputs[ModelInput::kMapFeatures] - inputs[ModelInput::kVoteNoise];
  return inputs;
}

double sum_of_terms(const MatcherModel& model, const MatchabilityInputs& inputs) {
  double sum = 0;
  for (const ModelTerm& term : model.terms) {
    const double part = term.coefficient * (inputs[term.input] - term.mean) / term.spread;
    sum += std::min(part, std::abs(term.coefficient) * term.most);
  }
  return sum;
}

FixPrediction predict_correct_fix(const MatcherModel& model, const MatchabilityInputs& inputs, double map_features) {
  FixPrediction prediction{0, model.level.sigma, model.level.tiles};
  if (map_features < kLeastMapFeatures) return prediction;
  prediction.p = p_over_level(model.level.mean + sum_of_terms(model, inputs), model.level.sigma);
  return prediction;
}

const MatcherModel& model_of(const MatchabilityModel& model, FlyingMatcher matcher) {
  for (const MatcherModel& candidate : model.matchers) {
    if (candidate.matcher == matcher) return candidate;
  }
  throw DataError("the matchability model has no parameters for the matcher \"" + flying_matcher_name(matcher) + "\"");
}

FixPrediction predict_correct_fix(const MatchabilityModel& model, FlyingMatcher matcher,
                                  const MatchabilityInputs& inputs, double map_features) {
  FixPrediction best = predict_correct_fix(model_of(model, matcher), inputs, map_features);
  if (matcher == FlyingMatcher::kFeatures) return best;
  for (const MatcherModel& other : model.matchers) {
    if (other.matcher != FlyingMatcher::kFeatures) continue;
    const FixPrediction without_chips = predict_correct_fix(other, inputs, map_features);
    if (without_chips.p > best.p) best = without_chips;
  }
  return best;
}

const MatchabilityModel& default_matchability_model() {
  static const MatchabilityModel kModel =
      matchability_model_from_json(parse_json("the default model", default_model::bytes()), "the default model");
  return kModel;
}

Json matchability_model_to_json(const MatchabilityModel& model) {
  Json matchers = Json::array();
  for (const MatcherModel& matcher : model.matchers) {
    Json terms = Json::array();
    for (const ModelTerm& term : matcher.terms) terms.push_back(term_to_json(term));
    matchers.push_back(
        {{"matcher", flying_matcher_name(matcher.matcher)}, {"terms", terms}, {"level", level_to_json(matcher.level)}});
  }
  return {{"format_version", kFormatVersion},
          {"date", model.date},
          {"places", model.places},
          {"anchors", model.anchors},
          {"matchers", matchers}};
}

MatchabilityModel matchability_model_from_json(const Json& json, const std::string& name) {
  JsonObject file(json, name);
  refuse_older(file, name);
  file.small_integer("format_version", kFormatVersion, kFormatVersion);
  MatchabilityModel model;
  model.date = file.text("date");
  model.places = file.texts("places");
  model.anchors = file.texts("anchors");
  for (JsonObject& entry : file.objects("matchers")) {
    MatcherModel matcher;
    matcher.matcher = value_named<FlyingMatcher>(entry.text("matcher"), entry.path("matcher"));
    for (JsonObject& term : entry.objects("terms")) matcher.terms.push_back(term_from_json(term));
    matcher.level = level_from_json(entry.object("level"));
    entry.finish();
    model.matchers.push_back(matcher);
  }
  file.finish();
  return model;
}

MatchabilityModel read_matchability_model(const std::filesystem::path& path) {
  return matchability_model_from_json(parse_json(path.string(), read_file(path)), path.string());
}

bool is_like_tested(const GridLevel& level) {
  const int side_px = level.matrix.tile_size_px;
  return side_px >= kSmallestTested_px && side_px <= kLargestTested_px && level.gsd_m <= kTestedGsd_m * kLikeTested &&
         level.gsd_m >= kTestedGsd_m / kLikeTested;
}

std::string tested_on_text() {
  return "frames of " + std::to_string(kSmallestTested_px) + " to " + std::to_string(kLargestTested_px) +
         " px of maps of " + format_fixed(kTestedGsd_m, 1) + " m/px";
}

}  // namespace pilotage
