#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "pilotage/base/options.h"
#include "pilotage/base/progress.h"
#include "pilotage/report/report.h"

#pragma GCC visibility push(default)

namespace pilotage {

/// Files in which a report can be handed on (docs/commands/report.md). A new one is a value here and a row of the table
/// in report_outputs.cc.
enum class ReportOutput {
  kHtml,
  kJson,
  kCog,
  kGpkg,
  kKmz,
  kKml,
  kRoute,
  kDji,
  kAutopilot,
  kGeojson,
  kMbtiles,
  kImagery,
  kStac,
  kPack,
  kAll
};

EnumNames<ReportOutput> enum_names(ReportOutput);

/// The help of an option that takes them: every name and what it is for.
const std::string& outputs_help();

/// Whether `outputs` ask for `which`, by name or as part of all; a pack by name alone.
bool asks_for(const std::vector<ReportOutput>& outputs, ReportOutput which);

/// Throws UsageError where parameters for an autopilot are asked for by name and nobody says which it is: before the
/// work.
void refuse_unnamed_autopilot(const std::vector<ReportOutput>& outputs, const std::optional<Autopilot>& autopilot);

/// The names of the files that `outputs` would write for a plan with these levels, without writing them; all of them
/// begin with `stem`. `with_scores` says whether cog brings its own score raster, `<stem>_scores.tif`.
std::vector<std::string> report_output_names(const std::string& stem, const std::vector<ReportOutput>& outputs,
                                             const std::vector<GridLevel>& levels, bool with_scores);

/// Whether a file of this name could be one of report_output_names(stem, all): leftovers of an earlier run are.
bool is_report_output(const std::string& stem, const std::string& name);

/// Writes them into `folder`, over what stands there, and returns the names; `report` is make_report(input). Throws
/// DataError, Interrupted.
std::vector<std::string> write_report_outputs(const std::filesystem::path& folder, const std::string& stem,
                                              const ReportInput& input, const Report& report,
                                              const std::vector<ReportOutput>& outputs, bool with_scores,
                                              int threads = 0, const Progress& progress = {});

/// Where imagery was asked for and is not among `written`: why. Nothing else.
std::optional<std::string> missing_imagery_warning(const std::vector<ReportOutput>& outputs,
                                                   const std::vector<std::string>& written);

}  // namespace pilotage

#pragma GCC visibility pop
