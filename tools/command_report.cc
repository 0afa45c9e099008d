#include <optional>

#include "commands.h"
#include "stage_files.h"
#include "version.h"

#include "pilotage/base/output_file.h"
#include "pilotage/report/page_pdf.h"
#include "pilotage/report/plan_report.h"
#include "pilotage/report/report.h"

namespace pilotage {
namespace {

struct ReportCommandOptions {
  StageFileOptions files;
  std::string report_json;
  std::string title;
  std::string evaluation;
  std::string pdf;
  std::string pdf_browser;

  template <class Self, class Fields>
  static void describe(Self& self, Fields& fields) {
    StageFileOptions::describe(self.files, fields);
    fields.path("report_json", self.report_json, "Also write the same numbers as JSON.");
    fields.field("title", self.title, "Title of the page; the route's name if not given.");
    fields.path("evaluation", self.evaluation,
                "Also show what the scores are worth: evaluation.json of score --evaluate, or its folder.");
    fields.path("pdf", self.pdf, "Also print the page into this PDF; needs Chromium.");
    fields.field("pdf_browser", self.pdf_browser,
                 "Browser to print with, one that takes Chromium's options. Default: the first that is installed.");
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
    if (!options.pdf.empty()) find_browser(options.pdf_browser);  // fails now, not after the work
    const StageFiles files = read_stage_files(options.files, invocation);
    ReportInput input = make_report_input(files.plan, files.scores, files.selection, input_files(files.plan),
                                          version_line(), invocation.threads, invocation.progress);
    input.title = options.title;
    if (!options.evaluation.empty()) {
      input.evaluation = read_evaluation_note(options.evaluation);
      input.inputs.push_back(input_file("evaluation", input.evaluation->file, ""));
    }
    const Report report = make_report(input);
    std::optional<OutputFile> numbers;
    if (!options.report_json.empty()) {
      numbers.emplace(options.report_json, invocation.overwrite);
      numbers->write(report_json(report).dump(1) + "\n");
    }
    OutputFile page(invocation.output, invocation.overwrite);
    page.write(report_html(report));
    std::optional<OutputFile> pdf;
    if (!options.pdf.empty()) {
      pdf.emplace(options.pdf, invocation.overwrite);
      print_page_to_pdf(page.temporary_path(), pdf->temporary_path(), {.browser = options.pdf_browser},
                        invocation.progress);
    }
    page.commit();
    if (numbers) numbers->commit();  // all appear, or none
    if (pdf) pdf->commit();
    CommandResult result;
    result.text = report.verdict_text + "\n";
    result.json = {{"output", invocation.output}, {"verdict", report.verdict_text}};
    return result;
  });
  return command;
}

}  // namespace pilotage
