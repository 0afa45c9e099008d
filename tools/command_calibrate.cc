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

namespace pilotage {
namespace {

struct CalibrateOptions {
  std::vector<std::string> anchors;
  std::string adapt;
  std::string date;

  template <class Self, class Fields>
  static void describe(Self& self, Fields& fields) {
    fields.field("anchors", self.anchors,
                 "Places whose share of correct fixes flights can expect: they set the level of P. Without it: all.");
    fields.path(
        "adapt", self.adapt,
        "Fit nothing, but move the level of this model (\"default\": the program's own) to what was found here.");
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

void add_fit_text(const MatcherModel& model, const std::vector<FitSet>& sets, CommandResult& result) {
  std::size_t samples = 0;
  std::int64_t correct = 0;
  for (const FitSet& set : sets) {
    samples += set.samples.size();
    correct += std::count_if(set.samples.begin(), set.samples.end(), [](const FitSample& s) { return s.correct; });
  }
  result.text += flying_matcher_name(model.matcher) + ": " + std::to_string(samples) + " tiles of " +
                 std::to_string(sets.size()) + " evaluations, " + std::to_string(correct) +
                 " correct; level differs by " + format_fixed(model.place_sigma, 2) +
                 " (logits, 1 sigma) among anchors\n";
}

}  // namespace

Command make_calibrate_command() {
  Command command;
  command.word = "calibrate";
  command.group = CommandGroup::kFlight;
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
    if (!anchors.empty() && !options.adapt.empty()) throw UsageError("--anchors has no meaning with --adapt");
    CommandResult result;
    MatchabilityModel model{options.date, {places.begin(), places.end()}, {anchors.begin(), anchors.end()}, {}};
    if (anchors.empty()) model.anchors = model.places;
    for (const auto& [matcher, sets] : read_sets(inputs, anchors, invocation.progress)) {
      report_progress(invocation.progress, "fitting " + flying_matcher_name(matcher), 0, 0);
      model.matchers.push_back(options.adapt.empty()
                                   ? fit_matcher_model(matcher, sets)
                                   : adapt_level(model_of(model_to_adapt(options.adapt), matcher), sets));
      add_fit_text(model.matchers.back(), sets, result);
    }
    output.write(json_text(matchability_model_to_json(model)));
    output.commit();
    result.json = {{"output", invocation.output}, {"model", matchability_model_to_json(model)}};
    return result;
  });
  return command;
}

}  // namespace pilotage
