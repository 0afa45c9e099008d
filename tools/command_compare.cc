#include "commands.h"
#include "standard_streams.h"
#include "version.h"

#include "pilotage/base/error.h"
#include "pilotage/base/output_file.h"
#include "pilotage/base/text.h"
#include "pilotage/camera/camera_options.h"
#include "pilotage/compare/comparison_files.h"
#include "pilotage/compare/comparison_summary.h"
#include "pilotage/raster/gdal_io.h"

namespace pilotage {
namespace {

struct CompareCommandOptions {
  CompareOptions compare;
  std::string frames;
  CameraOptions camera;

  template <class Self, class Fields>
  static void describe(Self& self, Fields& fields) {
    fields.path("frames", self.frames, "The frames (frames.csv), with their truth.");
    CompareOptions::describe(self.compare, fields);
    fields.group("camera", self.camera, "How the aircraft sees the ground.");
  }
};

std::string percent(double share) {
  return format_fixed(100 * share, 1) + " %";
}

void summarise_for_people(const Comparison& comparison, CommandResult& result) {
  for (const MethodSummary& summary : summarise(comparison)) {
    result.text += std::string(descriptor_method_title(summary.method)) + ": " +
                   format_fixed(summary.total.median_ms, 1) + " ms a frame; best 10 " + percent(summary.best.value()) +
                   "; correct fix " + percent(summary.correct.value()) + "; false fix " +
                   percent(summary.wrong.value()) + "\n";
  }
}

}  // namespace

Command make_compare_command() {
  Command command;
  command.word = "compare";
  command.group = CommandGroup::kTune;
  command.summary = "Compare ORB, BRIEF, SIFT and SURF on frames with truth";
  command.examples = {
      {"All methods on the frames of a flight.",
       "pilotage compare reference.tif --frames frames.csv --camera camera.yaml -o comparison.md"},
      {"Two of them on the frames as they are, only the numbers.",
       "pilotage compare reference.tif --frames frames.csv --camera camera.yaml --methods sift,surf --raw "
       "-o numbers.csv"}};
  command.inputs = {.name = "REFERENCE",
                    .help = "GDAL datasets, later ones on top.",
                    .min = 1,
                    .max = InputSpec::kMany,
                    .stream_flags = {"frames"}};
  command.output = {.kind = OutputKind::kFile,
                    .help =
                        "NAME.md: also writes NAME.csv, NAME.json and a picture for each method. NAME.csv or "
                        "NAME.json: that file alone.",
                    .files = [](const std::string& output) { return comparison_outputs(output); },
                    .stream_name = "comparison.csv"};
  command.reads_rasters = true;
  bind_options<CompareCommandOptions>(command, [](const CompareCommandOptions& options, const Invocation& invocation) {
    if (options.frames.empty()) throw UsageError("frames is missing; give --frames frames.csv");
    check_comparison_output(invocation.output, options.compare, invocation.overwrite);
    const Camera camera = make_camera(options.camera);
    const FrameTable table = frame_table_from_csv(options.frames, read_named_input(options.frames),
                                                  {options.compare.truth, FrameColumns::kAll});
    const Comparison comparison = compare(
        invocation.inputs, table.frames,
        [&](const FrameRecord& frame) { return read_gray8_picture(frame_path(options.frames, frame.file)); }, camera,
        options.compare, invocation.seed, invocation.progress);
    const ComparisonSource source{invocation.inputs, options.frames, version_line(), options.compare, invocation.seed};
    const auto written = write_comparison(invocation.output, comparison, source, invocation.overwrite);

    CommandResult result;
    summarise_for_people(comparison, result);
    result.json["methods"] = comparison_json(comparison, source)["methods"];
    result.json["outputs"] = nlohmann::ordered_json::array();
    for (const auto& file : written) result.json["outputs"].push_back(file.string());
    result.warnings = table.warnings;
    result.warnings.insert(result.warnings.end(), comparison.warnings.begin(), comparison.warnings.end());
    return result;
  });
  return command;
}

}  // namespace pilotage
