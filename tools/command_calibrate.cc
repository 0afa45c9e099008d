#include <algorithm>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "commands.h"
#include "stage_files.h"

#include "pilotage/base/error.h"
#include "pilotage/base/json_object.h"
#include "pilotage/base/output_file.h"
#include "pilotage/base/text.h"
#include "pilotage/evaluate/read_evaluation.h"
#include "pilotage/matchability/fit_model.h"
#include "pilotage/matchability/place_reliability.h"
#include "pilotage/matchability/quality_report.h"

namespace pilotage {
namespace {

struct CalibrateOptions {
  std::vector<std::string> anchors;
  std::vector<std::string> terms;
  std::string adapt;
  std::string date;

  template <class Self, class Fields>
  static void describe(Self& self, Fields& fields) {
    fields.field("anchors", self.anchors,
                 "Places whose share of correct fixes flights can expect: they set the level of P. Without it: all.");
    fields.field(
        "terms", self.terms,
        "What P is made of, each as INPUT or INPUT:MOST with the standard deviations above its mean from which "
        "on it promises no more. Default: map_features:3, fine_contrast:3.");
    fields.path(
        "adapt", self.adapt,
        "Fit nothing, but learn the level of this model (\"default\": the program's own) from what was found here.");
    fields.field("date", self.date, "Date that the model carries, as 2026-11-21; nothing else is dated.");
  }
};

struct NamedFolder {
  std::string place;
  std::string folder;
};

NamedFolder split(const std::string& input) {
  const std::size_t equals = input.find('=');
  if (equals == std::string::npos || equals == 0 || equals + 1 == input.size()) {
    throw UsageError("\"" + input + "\" is not PLACE=FOLDER");
  }
  return {input.substr(0, equals), input.substr(equals + 1)};
}

MatchabilityModel model_to_adapt(const std::string& path) {
  return path == "default" ? default_matchability_model() : read_matchability_model(path);
}

// The sets of each matcher, in the order of the inputs.
std::map<FlyingMatcher, std::vector<FitSet>> read_sets(const std::vector<NamedFolder>& inputs,
                                                       const std::set<std::string>& anchors, const Progress& progress) {
  std::int64_t done = 0;
  std::map<FlyingMatcher, std::vector<FitSet>> sets;
  for (const NamedFolder& input : inputs) {
    const bool anchor = anchors.empty() || anchors.contains(input.place);
    need_file(input.folder + "/evaluation.json", "score --evaluate");
    EvaluatedSet read = read_evaluated_set(input.folder, input.place, anchor);
    sets[read.matcher].push_back(std::move(read.set));
    report_progress(progress, "reading evaluations", ++done, std::ssize(inputs));
  }
  return sets;
}

TermChoice term_of(const std::string& text) {
  const std::size_t colon = text.find(':');
  TermChoice choice;
  std::vector<std::string> known;
  bool found = false;
  for (const auto& entry : enum_names(ModelInput{})) {
    known.emplace_back(entry.name);
    if (entry.name != text.substr(0, colon)) continue;
    choice.input = entry.value;
    found = true;
  }
  if (!found) throw UsageError("terms: \"" + text + "\" is no input; one of " + join(known, ", "));
  if (colon == std::string::npos) return choice;
  const auto most = parse_number(text.substr(colon + 1));
  if (!most || !(*most >= -10 && *most <= 10)) {
    throw UsageError("terms: \"" + text + "\": behind the colon stands a number from -10 to 10");
  }
  choice.most = *most;
  return choice;
}

std::vector<TermChoice> terms_of(const std::vector<std::string>& texts) {
  if (texts.empty()) return default_terms();
  std::vector<TermChoice> terms;
  for (const std::string& text : texts) terms.push_back(term_of(text));
  return terms;
}

std::string quality_text(const PredictionQuality& quality) {
  return "AUC " + estimate_text(quality.auc, 3) + ", calibration error " + estimate_text(quality.calibration_error, 3);
}

nlohmann::ordered_json reliability_json(const PlaceReliability& reliability) {
  nlohmann::ordered_json json = {{"inside", to_json(JudgedPredictor{"inside", "inside places", reliability.inside})},
                                 {"across", to_json(JudgedPredictor{"across", "across places", reliability.across})},
                                 {"places", nlohmann::ordered_json::array()}};
  for (const PredictedPlace& place : reliability.places) {
    json["places"].push_back({{"place", place.place},
                              {"anchor", place.anchor},
                              {"tiles", place.tiles},
                              {"correct", place.correct},
                              {"p", place.p},
                              {"p_low", place.p_low},
                              {"p_high", place.p_high},
                              {"log_score", place.log_score}});
  }
  return json;
}

// What P is worth inside places and across them, said and put into the result.
void add_reliability(FlyingMatcher matcher, const std::vector<FitSet>& sets, const std::vector<TermChoice>& terms,
                     const Invocation& invocation, CommandResult& result) {
  QualityOptions options;
  options.seed = invocation.seed;
  options.threads = invocation.threads;
  const PlaceReliability reliability = judge_places(matcher, sets, terms, options);
  const std::string name = flying_matcher_name(matcher);
  result.text += name + ": inside places: " + quality_text(reliability.inside) + "\n";
  result.json["reliability"][name] = reliability_json(reliability);
  if (reliability.places.empty()) return;
  const auto held = std::count_if(reliability.places.begin(), reliability.places.end(),
                                  [](const PredictedPlace& place) { return place.held(); });
  result.text += name + ": across places, each by the others: " + quality_text(reliability.across) +
                 "; success within its 80 % interval at " + std::to_string(held) + " of " +
                 std::to_string(reliability.places.size()) + " places\n";
}

void add_fit_text(const MatcherModel& model, const std::vector<FitSet>& sets, CommandResult& result) {
  std::size_t samples = 0;
  std::int64_t correct = 0;
  for (const FitSet& set : sets) {
    samples += set.samples.size();
    correct += std::count_if(set.samples.begin(), set.samples.end(), [](const FitSample& s) { return s.correct; });
  }
  result.text += flying_matcher_name(model.matcher) + ": " + std::to_string(samples) + " tiles of " +
                 std::to_string(sets.size()) + " evaluations, " + std::to_string(correct) + " correct; level " +
                 format_fixed(model.level.mean, 2) + " ± " + format_fixed(model.level.sigma, 2) +
                 " (logits, 1 sigma), places differ by " + format_fixed(model.level.spread, 2) +
                 " (80 %: " + format_fixed(model.level.spread_low, 2) + " … " +
                 format_fixed(model.level.spread_high, 2) + ")\n";
}

}  // namespace

Command make_calibrate_command() {
  Command command;
  command.word = "calibrate";
  command.group = CommandGroup::kTune;
  command.summary = "Fit P(correct fix) to evaluations of own imagery";
  command.examples = {{"Two places, judged at two sizes; the second place says how often fixes succeed.",
                       "pilotage calibrate north=north/64px north=north/96px south=south/64px south=south/96px "
                       "--anchors south --date 2026-11-21 -o model.json"}};
  command.inputs = {.name = "PLACE=FOLDER",
                    .help = "Folders that `score --evaluate` wrote, each with the place it shows.",
                    .min = 1,
                    .max = InputSpec::kMany};
  command.output = {
      .kind = OutputKind::kFile, .help = "Parameters for `score --model` (JSON).", .stream_name = "model.json"};
  bind_options<CalibrateOptions>(command, [](const CalibrateOptions& options, const Invocation& invocation) {
    OutputFile output(invocation.output, invocation.overwrite);
    std::vector<NamedFolder> inputs;
    std::set<std::string> places;
    for (const std::string& input : invocation.inputs) {
      inputs.push_back(split(input));
      places.insert(inputs.back().place);
    }
    const std::set<std::string> anchors(options.anchors.begin(), options.anchors.end());
    for (const std::string& anchor : anchors) {
      if (!places.contains(anchor)) throw UsageError("anchors: no input is of the place \"" + anchor + "\"");
    }
    const bool adapts = !options.adapt.empty();
    if (!anchors.empty() && adapts) throw UsageError("--anchors has no meaning with --adapt");
    if (!options.terms.empty() && adapts) throw UsageError("--terms has no meaning with --adapt");
    const std::vector<TermChoice> terms = terms_of(options.terms);
    CommandResult result;
    MatchabilityModel model{options.date, {places.begin(), places.end()}, {anchors.begin(), anchors.end()}, {}};
    if (anchors.empty()) model.anchors = model.places;
    for (const auto& [matcher, sets] : read_sets(inputs, anchors, invocation.progress)) {
      report_progress(invocation.progress, "fitting " + flying_matcher_name(matcher), 0, 0);
      model.matchers.push_back(adapts ? adapt_level(model_of(model_to_adapt(options.adapt), matcher), sets)
                                      : fit_matcher_model(matcher, sets, terms));
      add_fit_text(model.matchers.back(), sets, result);
      if (!adapts) add_reliability(matcher, sets, terms, invocation, result);
    }
    output.write(json_text(matchability_model_to_json(model)));
    output.commit();
    result.json["output"] = invocation.output;
    result.json["model"] = matchability_model_to_json(model);
    return result;
  });
  return command;
}

}  // namespace pilotage
