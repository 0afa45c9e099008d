#include <algorithm>
#include <filesystem>

#include "commands.h"
#include "score_outputs.h"
#include "stage_files.h"
#include "version.h"

#include "pilotage/base/error.h"
#include "pilotage/base/json_object.h"
#include "pilotage/base/output_file.h"
#include "pilotage/base/text.h"
#include "pilotage/score/describe_run.h"
#include "pilotage/score/score_run.h"
#include "pilotage/score/score_shard.h"

namespace pilotage {
namespace {

struct ScoreCommandOptions {
  ScoreRunOptions run;
  ScoreOutputOptions outputs;
  std::int64_t plan_shards = 0;
  std::string shard;
  std::string shards;

  template <class Self, class Fields>
  static void describe(Self& self, Fields& fields) {
    ScoreRunOptions::describe(self.run, fields);
    ScoreOutputOptions::describe(self.outputs, fields);
    fields.field("plan_shards", self.plan_shards, "Score nothing; say what so many shards are (-o: as JSON). 0: score.",
                 Range{0, static_cast<double>(kMostShards)});
    fields.field("shard", self.shard,
                 "Score a part of the tiles: 3/16 is the third of 16 shards; auto/16 takes the number from "
                 "SLURM_ARRAY_TASK_ID (1 …), JOB_COMPLETION_INDEX or AWS_BATCH_JOB_ARRAY_INDEX (0 …).");
    fields.path("shards", self.shards, "Folder of the shards' results, for `pilotage merge`; made when it is missing.");
  }
};

ScoreRun open_run(const ScoreCommandOptions& options, const Invocation& invocation) {
  const std::vector<std::string>& inputs = invocation.inputs;
  if (inputs.size() == 1 && inputs.front().ends_with(".json")) need_file(inputs.front(), "tile");
  return open_score_run(inputs, options.run, invocation.seed, invocation.progress);
}

// What belongs to the whole run is made by `merge`.
void refuse_outputs(const ScoreCommandOptions& options, const std::string& with, bool with_output) {
  const ScoreOutputOptions& outputs = options.outputs;
  const std::pair<const char*, bool> given[] = {{"-o", with_output},
                                                {"--table", !outputs.table.empty()},
                                                {"--second-epoch-output", !outputs.second_epoch_output.empty()},
                                                {"--level", outputs.level != 0},
                                                {"--evaluate", outputs.evaluate.wanted()}};
  for (const auto& [flag, is_given] : given) {
    if (is_given) throw UsageError(std::string(flag) + " does not go with " + with + "; give it to `pilotage merge`");
  }
}

std::string range_text(std::int64_t first, std::int64_t last) {
  return std::to_string(first) + (last > first ? " to " + std::to_string(last) : "");
}

CommandResult plan_shards(const ScoreCommandOptions& options, const Invocation& invocation) {
  refuse_outputs(options, "--plan-shards", false);
  const ScoreRun run = open_run(options, invocation);
  CommandResult result;
  result.text = std::to_string(options.plan_shards) + " shards of " + std::to_string(tile_count(run)) + " tiles\n";
  result.json = {{"tiles", tile_count(run)}, {"shards", nlohmann::ordered_json::array()}};
  for (std::int64_t number = 1; number <= options.plan_shards; ++number) {
    const Shard shard{number, options.plan_shards};
    const std::vector<ShardTile> tiles = shard_tiles(run, shard);
    nlohmann::ordered_json parts = nlohmann::ordered_json::array();
    std::vector<std::string> words;
    for (const ShardPart& part : shard_parts(tiles)) {
      words.push_back((run.flight ? "level " + std::to_string(part.level) + " " : "") + "columns " +
                      range_text(part.first_column, part.last_column) + " rows " +
                      range_text(part.first_row, part.last_row));
      parts.push_back({{"level", part.level},
                       {"columns", {part.first_column, part.last_column}},
                       {"rows", {part.first_row, part.last_row}},
                       {"tiles", part.tiles}});
    }
    result.text += "shard " + std::to_string(number) + "/" + std::to_string(options.plan_shards) + ": " +
                   std::to_string(tiles.size()) + " tiles: " + join(words, ", ") + "\n";
    result.json["shards"].push_back(
        {{"shard", number}, {"file", shard_file_name(shard)}, {"tiles", tiles.size()}, {"parts", parts}});
  }
  if (!invocation.output.empty()) write_file(invocation.output, json_text(result.json), invocation.overwrite);
  return result;
}

/// Whether the shard's result is there already. What is damaged is none, and will be replaced. Throws DataError for
/// that of another run.
bool is_done(const std::filesystem::path& file, const nlohmann::ordered_json& run, const Shard& shard,
             std::vector<std::string>& warnings) {
  std::error_code ignored;
  if (!std::filesystem::exists(file, ignored)) return false;
  try {
    const ScoreShard found = read_score_shard(file);
    const std::string difference = run_difference(found.run, run);
    if (difference.empty() && found.shard == shard) return true;
    throw DataError(file.string() + ": is of another run (" + difference +
                    " of this one); take another folder, or give --overwrite");
  } catch (const IntegrityError& error) {
    warnings.push_back(std::string(error.what()) + "; it is scored again");
    return false;
  }
}

CommandResult score_shard(const ScoreCommandOptions& options, const Invocation& invocation) {
  refuse_outputs(options, "--shard", !invocation.output.empty());
  if (options.shards.empty()) throw UsageError("shards is missing; give --shards FOLDER");
  const Shard shard = parse_shard(options.shard, environment_of_process);
  const ScoreRun run = open_run(options, invocation);
  std::vector<std::int64_t> places;
  for (const ShardTile& tile : shard_tiles(run, shard)) places.push_back(tile.place);
  std::sort(places.begin(), places.end());

  const std::filesystem::path file = std::filesystem::path(options.shards) / shard_file_name(shard);
  refuse_shared_files(invocation.named_inputs, {{"--shards", file}});
  std::error_code error;
  std::filesystem::create_directories(options.shards, error);
  if (error) throw DataError(options.shards + ": cannot be made: " + error.message());
  ScoreShard result{describe_run(run, version_line(), invocation.progress), shard, {}};
  CommandResult told;
  const bool done = !invocation.overwrite && is_done(file, result.run, shard, told.warnings);
  if (!done && shard.count > 1 && !options.run.score.second_epoch.empty()) {
    told.warnings.emplace_back("with a second date each shard registers both dates over all tiles of the run");
  }
  if (!done) {
    const Ground part = part_of_ground(run, places, invocation.threads);
    std::optional<SecondEpoch> second_epoch;
    if (!run.options.score.second_epoch.empty()) {  // from all tiles, whichever are scored, so that shards agree
      second_epoch = register_second_epoch(whole_ground(run, invocation.threads), run.options.score, invocation.threads,
                                           invocation.progress);
    }
    result.rows = tile_rows(part, score_ground_tiles(part, run.options.score,
                                                     second_epoch ? &second_epoch->registration.fit.field : nullptr,
                                                     run.seed, invocation.threads, invocation.progress));
    // A second task with the same shard writes the same bytes: whichever is last wins.
    write_file(file, score_shard_to_bytes(result), true);
  }
  told.text = "shard " + std::to_string(shard.number) + "/" + std::to_string(shard.count) + ": " +
              std::to_string(places.size()) + " tiles, " + (done ? "done already" : "written") + ": " + file.string() +
              "\n";
  told.json = {{"shard", shard.number},
               {"shards", shard.count},
               {"tiles", places.size()},
               {"file", file.string()},
               {"done_already", done}};
  return told;
}

CommandResult score_all(const ScoreCommandOptions& options, const Invocation& invocation) {
  if (!options.shards.empty()) throw UsageError("--shards goes with --shard");
  if (invocation.output.empty()) throw UsageError("-o OUTPUT is missing: where the score raster goes");
  const ScoreRun run = open_run(options, invocation);
  ScoreOutputs outputs(options.outputs, invocation, run);
  const Ground ground = whole_ground(run, invocation.threads);
  return outputs.write(ground,
                       score_ground(ground, run.options.score, run.seed, invocation.threads, invocation.progress));
}

}  // namespace

Command make_score_command() {
  Command command;
  command.word = "score";
  command.group = CommandGroup::kStages;
  command.summary = "Score tiles: variance, entropy, uniqueness";
  command.examples = {
      {"A raster on its own pixel grid.",
       "pilotage score ortho.tif --tile-size-px 256 --stride-px 64 --search-radius-px 128 -o scores.tif "
       "--table tiles.csv"},
      {"The tiles of a plan.", "pilotage score plan.json -o scores.tif --table tiles.csv"},
      {"Measured against a second date.",
       "pilotage score plan.json --second-epoch last_year.tif --second-epoch-output disagreement.tif -o scores.tif"},
      {"What the scores are worth: the matcher on another date.",
       "pilotage score ortho.tif --gsd-m 0.6 --tile-size-px 128 --evaluate later.tif -o scores.tif"},
      {"One of 16 parts, for as many machines; `pilotage merge` puts them together.",
       "pilotage score ortho.tif --shard 3/16 --shards parts"}};
  command.inputs = {
      .name = "RASTER", .help = "GDAL datasets, or one tile plan (plan.json).", .min = 1, .max = InputSpec::kMany};
  command.output = {
      .kind = OutputKind::kFile,
      .help =
          "Score raster (Cloud-Optimised GeoTIFF), one band per measure, with a QGIS style (.qml) beside it; not with "
          "--shard.",
      .required = false,
      .flags = {"table", "second-epoch-output", "shards"}};
  command.reads_rasters = true;
  bind_options<ScoreCommandOptions>(command, [](const ScoreCommandOptions& options, const Invocation& invocation) {
    if (options.plan_shards > 0 && !options.shard.empty()) throw UsageError("--plan-shards or --shard, not both");
    if (options.plan_shards > 0) return plan_shards(options, invocation);
    return options.shard.empty() ? score_all(options, invocation) : score_shard(options, invocation);
  });
  return command;
}

}  // namespace pilotage
