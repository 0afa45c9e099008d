#include <optional>

#include "commands.h"
#include "stage_files.h"
#include "version.h"

#include "pilotage/base/output_file.h"
#include "pilotage/report/plan_report.h"
#include "pilotage/report/report.h"

namespace pilotage {
namespace {

struct ReportCommandOptions {
  StageFileOptions files;
  std::string report_json;
  std::string title;

  template <class Self, class Fields>
  static void describe(Self& self, Fields& fields) {
    StageFileOptions::describe(self.files, fields);
    fields.path("report_json", self.report_json, "Also write the same numbers as JSON.");
    fields.field("title", self.title, "Title of the page; the route's name if not given.");
  }
};

}  // namespace

Command make_report_command() {
  Command command;
  command.word = "report";
  command.group = CommandGroup::kStages;
  command.summary = "Heat maps and a go / no-go page to open offline";
  command.examples = {{"From the files of the stages before.",
                       "pilotage report plan.json --table tiles.csv --selection selection.json -o report.html"}};
  command.inputs = {.name = "PLAN", .help = "The tile plan (plan.json).", .min = 1, .max = 1};
  command.output = {.kind = OutputKind::kFile, .help = "The page (one self-contained HTML file)."};
  bind_options<ReportCommandOptions>(command, [](const ReportCommandOptions& options, const Invocation& invocation) {
    const StageFiles files = read_stage_files(options.files, invocation);
    ReportInput input =
        make_report_input(files.plan, files.scores, files.selection, input_files(files.plan), version_line());
    input.title = options.title;
    const Report report = make_report(input);
    std::optional<OutputFile> numbers;
    if (!options.report_json.empty()) {
      numbers.emplace(options.report_json, invocation.overwrite);
      numbers->write(report_json(report).dump(1) + "\n");
    }
    write_file(invocation.output, report_html(report), invocation.overwrite);
    if (numbers) numbers->commit();  // both appear, or neither
    CommandResult result;
    result.text = report.verdict_text + "\n";
    result.json = {{"output", invocation.output}, {"verdict", report.verdict_text}};
    return result;
  });
  return command;
}

}  // namespace pilotage
