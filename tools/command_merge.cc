#include <algorithm>
#include <filesystem>
#include <optional>

#include "commands.h"
#include "score_outputs.h"
#include "version.h"

#include "pilotage/base/error.h"
#include "pilotage/score/merge_shards.h"

namespace pilotage {
namespace {

CommandResult missing_result(const MergedShards& merged) {
  const std::string list = number_list(merged.missing);
  CommandResult result;
  result.exit_code = kExitTryAgain;
  result.text = "missing: " + std::to_string(merged.missing.size()) + " of " + std::to_string(merged.count) +
                " shards: " + list + "\n";
  result.json = {{"shards", merged.count}, {"missing", merged.missing}, {"missing_list", list}};
  result.warnings = {"nothing was merged: shards " + list + " of " + std::to_string(merged.count) +
                     " are missing; score them and try again"};
  return result;
}

}  // namespace

Command make_merge_command() {
  Command command;
  command.word = "merge";
  command.group = CommandGroup::kStages;
  command.summary = "Put the shards of a score run together";
  command.examples = {{"What `pilotage score … -o scores.tif --table tiles.csv` writes, from shards.",
                       "pilotage merge parts -o scores.tif --table tiles.csv"}};
  command.inputs = {.name = "SHARDS",
                    .help = "The folder of `score --shards`, or the shards' files.",
                    .min = 1,
                    .max = InputSpec::kMany};
  command.output = {
      .kind = OutputKind::kFile,
      .help = "Score raster (Cloud-Optimised GeoTIFF), one band per measure, with a QGIS style (.qml) beside it.",
      .flags = {"table", "second-epoch-output"}};
  command.reads_rasters = true;
  bind_options<ScoreOutputOptions>(command, [](const ScoreOutputOptions& options, const Invocation& invocation) {
    MergedShards merged = read_shards(shard_files(invocation.inputs), version_line(), invocation.progress);
    if (!merged.missing.empty()) return missing_result(merged);
    ScoreOutputs outputs(options, invocation, merged.run);
    const Ground ground = whole_ground(merged.run, invocation.threads);
    GroundScores all{std::move(merged.scores), {}};
    const ScoreOptions& score = merged.run.options.score;
    if (!score.second_epoch.empty()) {
      all.second_epoch = register_second_epoch(ground, score, invocation.threads, invocation.progress);
    }
    explain_scores(ground, all.scores, invocation.threads);
    return outputs.write(ground, all);
  });
  return command;
}

}  // namespace pilotage
