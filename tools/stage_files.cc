#include "stage_files.h"

#include "pilotage/base/error.h"
#include "pilotage/base/output_file.h"
#include "pilotage/mission/plan_file.h"
#include "pilotage/mission/selection_file.h"
#include "pilotage/mission/tile_table.h"

namespace pilotage {

std::vector<TileScore> read_scores(const std::string& table) {
  if (table.empty()) throw UsageError("table is missing; give --table tiles.csv");
  std::vector<TileScore> scores;
  for (const TileRow& row : tile_table_from_csv(table, read_file(table))) scores.push_back(row.score);
  return scores;
}

StageFiles read_stage_files(const StageFileOptions& options, const Invocation& invocation) {
  if (options.selection.empty()) throw UsageError("selection is missing; give --selection selection.json");
  return {read_plan(invocation.inputs.front()), read_scores(options.table), read_selection(options.selection)};
}

}  // namespace pilotage
