#include "pilotage/matchability/matchability_model.h"

#include <algorithm>
#include <cmath>

#include <nlohmann/json.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/json_object.h"
#include "pilotage/base/options_json.h"
#include "pilotage/base/output_file.h"
#include "pilotage/base/text.h"
#include "pilotage/matchability/default_model_bytes.h"

namespace pilotage {
namespace {

constexpr int kFormatVersion = 1;
constexpr double kMinFeatures = 20;  // match() refuses a map with fewer in its window
constexpr double kUnlikeAnySeen = 3;

using Json = nlohmann::ordered_json;

double term(const ModelTerm& term, double x) {
  return term.coefficient * std::min(x - term.mean, kUnlikeAnySeen * term.spread);
}

Json term_to_json(const ModelTerm& term) {
  return {{"coefficient", term.coefficient}, {"mean", term.mean}, {"spread", term.spread}};
}

ModelTerm term_from_json(JsonObject json) {
  const ModelTerm term{json.number("coefficient"), json.number("mean"), json.positive_number("spread")};
  json.finish();
  return term;
}

FlyingMatcher matcher_named(const std::string& name, const std::string& path) {
  std::vector<std::string> known;
  for (const auto& entry : enum_names(FlyingMatcher{})) {
    if (entry.name == name) return entry.value;
    known.emplace_back(entry.name);
  }
  throw DataError(path + " = \"" + name + "\": one of " + join(known, ", "));
}

}  // namespace

std::string flying_matcher_name(FlyingMatcher matcher) {
  for (const auto& entry : enum_names(FlyingMatcher{})) {
    if (entry.value == matcher) return std::string(entry.name);
  }
  return {};
}

MatchabilityInputs matchability_inputs(const TileScores& score, int tile_size_px, double black) {
  double contrast = std::sqrt(std::max(score.frieden_deficit, 0.0));
  if (black != 0 && contrast > 0) {
    const double mean = score.gray_variance / contrast;
    contrast = score.gray_variance / std::max(mean - black, 1e-9 * std::abs(mean));
  }
  const double noise = std::isnan(score.vote_noise) ? 0 : score.vote_noise;
  const double described_px = std::max(tile_size_px - 2 * kDescriptorBorder_px, 4);
  return {std::log((score.map_features + 2) / (noise + 0.3)), std::log(contrast + 0.01), 2 * std::log(described_px)};
}

double predict_p_correct_fix(const MatcherModel& model, const MatchabilityInputs& inputs, double map_features) {
  if (map_features < kMinFeatures) return 0;
  const double z = model.intercept + term(model.vote_contrast, inputs.vote_contrast) +
                   term(model.gray_contrast, inputs.gray_contrast) + model.area_coefficient * inputs.described_area;
  return 1 / (1 + std::exp(-z));
}

const MatcherModel& model_of(const MatchabilityModel& model, FlyingMatcher matcher) {
  for (const MatcherModel& candidate : model.matchers) {
    if (candidate.matcher == matcher) return candidate;
  }
  throw DataError("the matchability model has no parameters for the matcher \"" + flying_matcher_name(matcher) + "\"");
}

double predict_p_correct_fix(const MatchabilityModel& model, FlyingMatcher matcher, const MatchabilityInputs& inputs,
                             double map_features) {
  double p = predict_p_correct_fix(model_of(model, matcher), inputs, map_features);
  if (matcher == FlyingMatcher::kFeatures) return p;
  for (const MatcherModel& other : model.matchers) {
    if (other.matcher == FlyingMatcher::kFeatures) p = std::max(p, predict_p_correct_fix(other, inputs, map_features));
  }
  return p;
}

const MatchabilityModel& default_matchability_model() {
  static const MatchabilityModel kModel =
      matchability_model_from_json(parse_json("the default model", default_model::bytes()), "the default model");
  return kModel;
}

Json matchability_model_to_json(const MatchabilityModel& model) {
  Json matchers = Json::array();
  for (const MatcherModel& matcher : model.matchers) {
    matchers.push_back({{"matcher", flying_matcher_name(matcher.matcher)},
                        {"vote_contrast", term_to_json(matcher.vote_contrast)},
                        {"gray_contrast", term_to_json(matcher.gray_contrast)},
                        {"intercept", matcher.intercept},
                        {"area_coefficient", matcher.area_coefficient},
                        {"place_sigma", matcher.place_sigma}});
  }
  return {{"format_version", kFormatVersion},
          {"date", model.date},
          {"places", model.places},
          {"anchors", model.anchors},
          {"matchers", matchers}};
}

MatchabilityModel matchability_model_from_json(const Json& json, const std::string& name) {
  JsonObject file(json, name);
  file.small_integer("format_version", kFormatVersion, kFormatVersion);
  MatchabilityModel model;
  model.date = file.text("date");
  model.places = file.texts("places");
  model.anchors = file.texts("anchors");
  for (JsonObject& entry : file.objects("matchers")) {
    MatcherModel matcher;
    matcher.matcher = matcher_named(entry.text("matcher"), entry.path("matcher"));
    matcher.vote_contrast = term_from_json(entry.object("vote_contrast"));
    matcher.gray_contrast = term_from_json(entry.object("gray_contrast"));
    matcher.intercept = entry.number("intercept");
    matcher.area_coefficient = entry.number("area_coefficient");
    matcher.place_sigma = entry.number("place_sigma");
    entry.finish();
    model.matchers.push_back(matcher);
  }
  file.finish();
  return model;
}

MatchabilityModel read_matchability_model(const std::filesystem::path& path) {
  return matchability_model_from_json(parse_json(path.string(), read_file(path)), path.string());
}

}  // namespace pilotage
