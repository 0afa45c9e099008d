#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "commands.h"
#include "stage_files.h"
#include "version.h"

#include "pilotage/base/error.h"
#include "pilotage/base/json_object.h"
#include "pilotage/base/output_file.h"
#include "pilotage/base/staging_folder.h"
#include "pilotage/gis/report_outputs.h"
#include "pilotage/mission/planned_landmarks.h"
#include "pilotage/mission/simulation_file.h"
#include "pilotage/report/autopilot_sheet.h"
#include "pilotage/report/compare_reports.h"
#include "pilotage/report/page_pdf.h"
#include "pilotage/report/plan_report.h"
#include "pilotage/report/report.h"
#include "pilotage/report/report_file.h"
#include "pilotage/report/simulated_flights.h"
#include "pilotage/verdict/disagreement.h"
#include "pilotage/verdict/evidence.h"

namespace pilotage {
namespace {

struct ReportCommandOptions {
  StageFileOptions files;
  bool compare = false;
  std::vector<ReportOutput> outputs{ReportOutput::kHtml};
  std::optional<Autopilot> autopilot;
  std::string report_json;
  std::string title;
  std::string evaluation;
  std::vector<std::string> simulation;
  std::string envelope;
  std::string replay;
  std::string landmarks;
  bool require = false;
  std::string pdf;
  std::string pdf_browser;

  template <class Self, class Fields>
  static void describe(Self& self, Fields& fields) {
    StageFileOptions::describe(self.files, fields);
    fields.field("compare", self.compare, "Say what changed between two report.json; -o takes it as JSON.");
    fields.field("outputs", self.outputs, outputs_help());
    fields.field("autopilot", self.autopilot, kAutopilotHelp);
    fields.path("report_json", self.report_json, "Also write the numbers as JSON here, wherever --outputs puts them.");
    fields.field("title", self.title, "Title of the page; the route's name if not given.");
    fields.path("evaluation", self.evaluation,
                "Also show what the scores are worth: evaluation.json of score --evaluate, or its folder.");
    fields.path(
        "simulation", self.simulation,
        "Also show, and judge by, simulated flights: simulation.json of simulate or prepare, of these files; two "
        "of them where fixes of the one are drawn and of the other by frames. Of prepare's folder its own is taken.");
    fields.path(
        "envelope", self.envelope,
        "Also show how far the flight may leave its plan, and how bad its frames may be: envelope.json of envelope.");
    fields.path("replay", self.replay,
                "Also show, and judge by, flights that were flown: replay.json of replay, with --plan.");
    fields.path("landmarks", self.landmarks,
                "Also show what the landmarks of the onboard map promise: the file of landmark-score --for-map that it "
                "was built with.");
    fields.field("require", self.require, "Exit with 3 when the verdict is NO-GO.");
    fields.path("pdf", self.pdf, "Also print the page into this PDF; needs Chromium.");
    fields.field("pdf_browser", self.pdf_browser,
                 "Browser to print with, one that takes Chromium's options. Default: the first that is installed.");
  }
};

// The page is the output; the other files stand beside it and begin with its name.
struct OutputPlace {
  std::filesystem::path folder;
  std::string page;
  std::string stem;
};

OutputPlace place_of(const std::string& output) {
  const std::filesystem::path path(output);
  return {path.has_parent_path() ? path.parent_path() : ".", path.filename().string(), path.stem().string()};
}

void check_outputs(const OutputPlace& place, const std::vector<std::string>& names, const Invocation& invocation) {
  std::vector<NamedFile> outputs;
  for (const std::string& name : names) outputs.push_back({"--outputs", place.folder / name});
  refuse_shared_files(invocation.named_inputs, outputs);
  for (const NamedFile& output : outputs) const OutputFile refused(output.path, invocation.overwrite);
}

// A part of all outputs that is not missed; asked for by name it is.
void refuse_pack(const std::vector<ReportOutput>& outputs) {
  if (std::find(outputs.begin(), outputs.end(), ReportOutput::kPack) == outputs.end()) return;
  throw UsageError("--outputs pack: a pack holds the map, too: `pilotage prepare --outputs pack` makes it");
}

/// Parameters that an earlier report wrote for an autopilot of the other family.
std::vector<std::string> of_another_autopilot(const OutputPlace& place, const std::vector<ReportOutput>& outputs,
                                              const std::vector<std::string>& written) {
  std::vector<std::string> others;
  if (!asks_for(outputs, ReportOutput::kAutopilot)) return others;
  for (const std::string& name : report_output_names(place.stem, {ReportOutput::kAutopilot}, {}, false)) {
    std::error_code ignored;
    const bool is_other = std::find(written.begin(), written.end(), name) == written.end();
    if (is_other && std::filesystem::exists(place.folder / name, ignored)) others.push_back(name);
  }
  return others;
}

/// What the report is made of: files that are named, or those beside the plan in the folder that prepare wrote.
struct ReportFiles {
  std::string plan;
  StageFileOptions names;
  std::vector<std::string> simulations;
  std::vector<std::string> warnings;
};

/// Whether a simulation flew these files.
bool is_simulation_of(const std::string& file, const std::vector<InputFile>& of) {
  const Simulation simulation = read_simulation(file);
  return std::all_of(of.begin(), of.end(), [&](const InputFile& one) {
    return std::any_of(simulation.inputs.begin(), simulation.inputs.end(), [&](const InputFile& simulated) {
      return simulated.role == one.role && simulated.digest == one.digest;
    });
  });
}

ReportFiles files_of_report(const ReportCommandOptions& options, const std::string& given) {
  const std::filesystem::path plan = plan_of(given);
  ReportFiles files{plan.string(), options.files, options.simulation, {}};
  const bool is_folder = plan != std::filesystem::path(given);
  if (is_folder) files.names = stage_files_beside(plan, options.files);
  std::error_code ignored;
  const std::string beside = (plan.parent_path() / "simulation.json").string();
  if (!files.simulations.empty() || files.names.table.empty() || files.names.selection.empty() ||
      !std::filesystem::exists(beside, ignored)) {
    return files;
  }
  const bool fits = is_simulation_of(beside, simulated_inputs(files.plan, files.names.table, files.names.selection));
  if (fits && is_folder) {
    files.simulations.push_back(beside);
  } else if (fits) {
    files.warnings.push_back(beside + " flew this plan and is not shown: give it as --simulation, or the folder");
  } else if (is_folder) {
    files.warnings.push_back(beside + " is of other files and not shown; run `pilotage simulate` again");
  }
  return files;
}

ReportInput read_report_input(const ReportCommandOptions& options, const ReportFiles& named, const StageFiles& files,
                              const Invocation& invocation) {
  ReportInput input =
      make_report_input(files.mission, files.scores, files.selection, input_files(files.mission), version_line());
  if (asks_for(options.outputs, ReportOutput::kHtml)) add_pictures(input, invocation.threads, invocation.progress);
  input.title = options.title;
  if (georeference_disagreement(judged_plan(input))) {
    input.assumptions.emplace_back("what bringing the second date onto the imagery took for granted, `score` says");
  }
  if (!options.evaluation.empty()) {
    input.evaluation = read_evaluation_note(options.evaluation);
    input.inputs.push_back(input_file("evaluation", input.evaluation->file, ""));
  }
  for (const std::string& file : named.simulations) {
    add_simulation(input, read_simulation(file), file,
                   simulated_inputs(named.plan, named.names.table, named.names.selection));
    input.inputs.push_back(input_file("simulation", file, ""));
  }
  if (!options.envelope.empty()) {
    input.envelope = read_envelope_note(options.envelope);
    input.inputs.push_back(input_file("envelope", options.envelope, ""));
  }
  if (!options.replay.empty()) {
    input.replay = read_replay_note(options.replay);
    refuse_other_replay(*input.replay, input.selection);
    input.inputs.push_back(input_file("replay", options.replay, ""));
  }
  if (!options.landmarks.empty()) {
    input.landmarks = std::make_shared<MapLandmarks>(read_planned_landmarks(files.mission.ground, options.landmarks));
    input.inputs.push_back(input_file("landmarks", options.landmarks, ""));
  }
  return input;
}

CommandResult report_of_plan(const ReportCommandOptions& options, const Invocation& invocation) {
  const bool prints = !options.pdf.empty();
  if (prints && !asks_for(options.outputs, ReportOutput::kHtml)) {
    throw UsageError("--pdf prints the page: give html among --outputs");
  }
  if (prints) find_browser(options.pdf_browser);  // fails now, not after the work
  const OutputPlace place = place_of(invocation.output);
  const ReportFiles named = files_of_report(options, invocation.inputs.front());
  StageFiles files = read_stage_files(named.plan, named.names);
  if (options.autopilot) files.mission.flight.autopilot = options.autopilot;
  refuse_pack(options.outputs);
  refuse_unnamed_autopilot(options.outputs, files.mission.flight.autopilot);
  check_outputs(place, report_output_names(place.stem, options.outputs, files.mission.ground.levels, true), invocation);
  const ReportInput input = read_report_input(options, named, files, invocation);
  const Report report = make_report(input);
  std::optional<OutputFile> numbers;
  if (!options.report_json.empty()) {
    numbers.emplace(options.report_json, invocation.overwrite);
    numbers->write(json_text(report_json(report)));
  }
  const StagingFolder staging(place.folder);
  std::vector<std::string> written = write_report_outputs(staging / "", place.stem, input, report, options.outputs,
                                                          true, invocation.threads, invocation.progress);
  for (std::string& name : written) {
    if (name == place.page || name != place.stem + ".html") continue;
    std::filesystem::rename(staging / name, staging / place.page);  // -o page.htm is meant as it stands
    name = place.page;
  }
  std::optional<OutputFile> pdf;
  if (prints) {
    pdf.emplace(options.pdf, invocation.overwrite);
    print_page_to_pdf(staging / place.page, pdf->temporary_path(), {.browser = options.pdf_browser},
                      invocation.progress);
  }
  std::vector<const OutputFile*> others;
  if (numbers) others.push_back(&*numbers);
  if (pdf) others.push_back(&*pdf);
  const auto imagery_warning = missing_imagery_warning(options.outputs, written);
  staging.publish(written, of_another_autopilot(place, options.outputs, written), others);  // all appear, or none
  CommandResult result;
  const std::string evidence = evidence_line(report.quality);
  result.text = report.verdict_text + "\n" + report.assumptions + "\n" + evidence + "\n";
  if (report.ageing) result.text += report.ageing->sentence + "\n";
  if (options.require && report.verdict == QualityStatus::kBad) result.exit_code = kExitGateNotMet;
  result.json = {{"output", invocation.output},
                 {"files", written},
                 {"verdict", report.verdict_text},
                 {"assumptions", report.assumptions},
                 {"evidence", evidence}};
  if (report.ageing) result.json["holds"] = report.ageing->sentence;
  result.warnings = named.warnings;
  if (imagery_warning) result.warnings.push_back(*imagery_warning);
  if (const auto& autopilot = files.mission.flight.autopilot) {
    const std::vector<std::string> more = autopilot_warnings(input, report, *autopilot);
    result.warnings.insert(result.warnings.end(), more.begin(), more.end());
  }
  return result;
}

CommandResult comparison_of_reports(const Invocation& invocation) {
  if (invocation.inputs.size() != 2) {
    throw UsageError("compare takes two reports, " + std::to_string(invocation.inputs.size()) +
                     " is given: pilotage report --compare a.json b.json");
  }
  const ReportComparison comparison =
      compare_reports(read_report(invocation.inputs[0]), read_report(invocation.inputs[1]),
                      {invocation.inputs[0], invocation.inputs[1]});
  CommandResult result;
  result.text = report_comparison_text(comparison);
  result.json = report_comparison_json(comparison);
  if (!invocation.output.empty()) {
    write_file(invocation.output, json_text(result.json), invocation.overwrite);
  }
  return result;
}

CommandResult run_report(const ReportCommandOptions& options, const Invocation& invocation) {
  if (options.compare) return comparison_of_reports(invocation);
  if (invocation.inputs.size() != 1) throw UsageError("two inputs are for --compare; a report is made of one plan");
  if (invocation.output.empty()) throw UsageError("output is missing; give -o report.html");
  return report_of_plan(options, invocation);
}

}  // namespace

Command make_report_command() {
  Command command;
  command.word = "report";
  command.group = CommandGroup::kStages;
  command.summary = "Heat maps and a go / no-go page to open offline";
  command.examples = {{"Once more of what prepare wrote.", "pilotage report out -o report.html"},
                      {"From the files of the stages before.",
                       "pilotage report plan.json --table tiles.csv --selection selection.json -o report.html"},
                      {"For QGIS and Google Earth as well.",
                       "pilotage report plan.json --table tiles.csv --selection selection.json --outputs "
                       "html,cog,gpkg,kmz -o report.html"},
                      {"What changed between two plans.", "pilotage report --compare before/report.json report.json"}};
  command.inputs = {.name = "INPUT",
                    .help =
                        "The folder that prepare wrote, whose files are taken where none are named, or the tile "
                        "plan (plan.json); with --compare two reports (report.json).",
                    .min = 1,
                    .max = 2};
  command.output = {.kind = OutputKind::kFile,
                    .help = "The page (one self-contained HTML file); other outputs stand beside it with its name.",
                    .required = false,
                    .flags = {"report-json", "pdf"}};
  command.reads_rasters = true;
  bind_options<ReportCommandOptions>(command, run_report);
  return command;
}

}  // namespace pilotage
