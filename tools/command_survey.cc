#include <filesystem>

#include "commands.h"
#include "version.h"

#include "pilotage/base/json_object.h"
#include "pilotage/base/text.h"
#include "pilotage/survey/run_survey.h"

namespace pilotage {

Command make_survey_command() {
  Command command;
  command.word = "survey";
  command.group = CommandGroup::kPrepare;
  command.summary = "Imagery without a route: where could a camera find its place";
  command.examples = {{"An orthophoto and a camera by its name, 120 m above ground.",
                       "pilotage survey ortho.tif --camera-name \"DJI Mavic 3E\" --agl-m 120 -o out/"},
                      {"With an elevation model and a second date of the same ground.",
                       "pilotage survey ortho.tif --camera camera.yaml --agl-m 120 --elevation dem.tif "
                       "--second-epoch last_year.tif -o out/"}};
  command.inputs = {.name = "RASTER",
                    .help = "Georeferenced imagery of the area: GDAL datasets, later ones on top.",
                    .min = 1,
                    .max = InputSpec::kMany};
  command.output = {.kind = OutputKind::kFolder,
                    .help =
                        "Folder for survey.html, survey.json, survey.gpkg, survey.kmz, survey_squares.csv, and the "
                        "scores and classes as rasters and table.",
                    .files = [](const std::string& folder) {
                      std::vector<std::filesystem::path> files;
                      for (const std::string& name : earlier_survey_outputs(folder)) {
                        files.push_back(std::filesystem::path(folder) / name);
                      }
                      return files;
                    }};
  command.reads_rasters = true;
  bind_options<SurveyOptions>(command, [](const SurveyOptions& options, const Invocation& invocation) {
    const SurveyRun run{invocation.output, invocation.overwrite, invocation.seed, invocation.threads, version_line()};
    const SurveyResult done = run_survey(invocation.inputs, options, run, invocation.progress);
    const std::string page = (std::filesystem::path(invocation.output) / "survey.html").string();
    CommandResult result;
    result.text = done.headline + "\n" + done.detail + "\nassumes: " + join(done.assumptions, "; ") +
                  "\nnot looked at: " + done.not_looked_at + "\n" +
                  (done.landmarks.empty() ? "" : "landmarks: " + done.landmarks + "\n" + done.landmarks_assume + "\n") +
                  std::to_string(done.tiles) + " tiles of " + format_fixed(done.tile_m, 0) + " m, one every " +
                  format_fixed(done.stride_m, 0) + " m; " + std::to_string(done.squares) +
                  (done.squares == 1 ? " square" : " squares") + " of the kilometre grid\nreport: " + page + "\n";
    result.json = {{"headline", done.headline},
                   {"detail", done.detail},
                   {"assumptions", done.assumptions},
                   {"not_looked_at", done.not_looked_at},
                   {"output", invocation.output},
                   {"files", done.files},
                   {"tiles", done.tiles},
                   {"squares", done.squares},
                   {"area_km2", json_number(done.area_km2)},
                   {"go_share", json_number(done.go_share)},
                   {"marginal_share", json_number(done.marginal_share)},
                   {"no_go_share", json_number(done.no_go_share)}};
    if (!done.landmarks.empty())
      result.json["landmarks"] = {{"said", done.landmarks}, {"assumes", done.landmarks_assume}};
    result.warnings = done.warnings;
    return result;
  });
  return command;
}

}  // namespace pilotage
