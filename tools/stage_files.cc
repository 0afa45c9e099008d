#include "stage_files.h"

#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>

#include "pilotage/base/error.h"
#include "pilotage/base/output_file.h"
#include "pilotage/ground/score_table.h"
#include "pilotage/mission/plan_file.h"
#include "pilotage/mission/selection_file.h"

namespace pilotage {
void need_file(const std::string& path, const std::string& writer) {
  std::error_code ignored;
  if (std::filesystem::exists(path, ignored)) return;
  throw DataError(path + ": does not exist; `pilotage " + writer + "` writes it");
}

void refuse_empty(const std::string& flag, const std::optional<std::string>& value) {
  if (value && value->empty()) throw UsageError(flag + " = \"\" is empty: give a value, or leave the option out");
}

Mission read_stage_plan(const std::string& path) {
  need_file(path, "tile");
  return read_plan(path);
}

std::vector<TileScores> read_scores(const std::string& table, const Ground& ground, const std::string& plan) {
  if (table.empty()) {
    throw UsageError("table is missing; give --table tiles.csv, which `pilotage score --table` writes");
  }
  need_file(table, "score --table");
  return scores_of(ground, tile_table_from_csv(table, read_file(table)), table, plan);
}

StageFiles read_stage_files(const std::string& plan, const StageFileOptions& options) {
  if (options.selection.empty()) {
    throw UsageError("selection is missing; give --selection selection.json, which `pilotage select` writes");
  }
  Mission mission = read_stage_plan(plan);
  std::vector<TileScores> scores = read_scores(options.table, mission.ground, plan);
  need_file(options.selection, "select");
  StageFiles files{std::move(mission), std::move(scores), read_selection(options.selection)};
  for (const std::int64_t id : files.selection.tile_ids) tile_index(files.mission.ground, id, options.selection);
  if (files.selection.legs.size() != files.mission.flight.route.legs.size()) {
    throw DataError(options.selection + ": has " + std::to_string(files.selection.legs.size()) + " legs, " + plan +
                    " has " + std::to_string(files.mission.flight.route.legs.size()));
  }
  return files;
}

std::filesystem::path plan_of(const std::string& input) {
  const std::filesystem::path path(input);
  return std::filesystem::is_directory(path) ? path / "plan.json" : path;
}

StageFileOptions stage_files_beside(const std::filesystem::path& plan, StageFileOptions options) {
  if (options.table.empty()) options.table = (plan.parent_path() / "tiles.csv").string();
  if (options.selection.empty()) options.selection = (plan.parent_path() / "selection.json").string();
  return options;
}

std::filesystem::path map_beside(const std::filesystem::path& plan, const std::string& named) {
  const std::filesystem::path map = named.empty() ? plan.parent_path() / "map.gpkg" : std::filesystem::path(named);
  need_file(map.string(), "prepare");
  return map;
}

}  // namespace pilotage
