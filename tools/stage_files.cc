#include "stage_files.h"

#include <cstdint>
#include <filesystem>
#include <set>
#include <string>
#include <utility>

#include "pilotage/base/error.h"
#include "pilotage/base/output_file.h"
#include "pilotage/ground/tile_table.h"
#include "pilotage/mission/plan_file.h"
#include "pilotage/mission/selection_file.h"

namespace pilotage {
namespace {

template <class Item>
std::set<std::int64_t> ids_of(const std::vector<Item>& items) {
  std::set<std::int64_t> ids;
  for (const Item& item : items) ids.insert(item.tile_id);
  return ids;
}

}  // namespace

void need_file(const std::string& path, const std::string& writer) {
  std::error_code ignored;
  if (std::filesystem::exists(path, ignored)) return;
  throw DataError(path + ": does not exist; `pilotage " + writer + "` writes it");
}

Mission read_stage_plan(const std::string& path) {
  need_file(path, "tile");
  return read_plan(path);
}

std::vector<TileScore> read_scores(const std::string& table) {
  if (table.empty()) {
    throw UsageError("table is missing; give --table tiles.csv, which `pilotage score --table` writes");
  }
  need_file(table, "score --table");
  std::vector<TileScore> scores;
  for (const TileRow& row : tile_table_from_csv(table, read_file(table))) scores.push_back(row.score);
  return scores;
}

StageFiles read_stage_files(const StageFileOptions& options, const Invocation& invocation) {
  if (options.selection.empty()) {
    throw UsageError("selection is missing; give --selection selection.json, which `pilotage select` writes");
  }
  Mission plan = read_stage_plan(invocation.inputs.front());
  std::vector<TileScore> scores = read_scores(options.table);
  need_file(options.selection, "select");
  StageFiles files{std::move(plan), std::move(scores), read_selection(options.selection)};
  const std::set<std::int64_t> planned = ids_of(files.plan.ground.tiles);
  if (ids_of(files.scores) != planned) {
    throw DataError(options.table + ": is of other tiles than " + invocation.inputs.front() + " (" +
                    std::to_string(files.scores.size()) + " scores, " + std::to_string(planned.size()) + " tiles)");
  }
  for (const std::int64_t id : files.selection.tile_ids) {
    if (!planned.contains(id)) {
      throw DataError(options.selection + ": tile " + std::to_string(id) + " is not in " + invocation.inputs.front());
    }
  }
  if (files.selection.legs.size() != files.plan.flight.route.legs.size()) {
    throw DataError(options.selection + ": has " + std::to_string(files.selection.legs.size()) + " legs, " +
                    invocation.inputs.front() + " has " + std::to_string(files.plan.flight.route.legs.size()));
  }
  return files;
}

}  // namespace pilotage
