#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "command.h"

#include "pilotage/flightlog/frame_match.h"
#include "pilotage/ground/tile_scores.h"
#include "pilotage/mapdb/parallel_reading.h"
#include "pilotage/mission/mission.h"
#include "pilotage/mission/selection.h"

namespace pilotage {

/// The files that earlier stages wrote beside the plan.
struct StageFileOptions {
  std::string table;
  std::string selection;

  template <class Self, class Fields>
  static void describe(Self& self, Fields& fields) {
    fields.path("table", self.table, "The scores: tiles.csv of the plan.");
    fields.path("selection", self.selection, "The selection: selection.json of the plan.");
  }
};

struct StageFiles {
  Mission mission;
  std::vector<TileScores> scores;
  Selection selection;
};

/// Throws DataError "plan.json: does not exist; `pilotage tile` writes it" when there is no file of this name; `writer`
/// is the command to run first.
void need_file(const std::string& path, const std::string& writer);

/// Throws UsageError when an option was given, but as "": a script whose variable is not set must not switch a check
/// off.
void refuse_empty(const std::string& flag, const std::optional<std::string>& value);

/// The plan of a file. Throws as need_file and read_plan do.
Mission read_stage_plan(const std::string& path);

/// The scores of a table, in the order of the tiles of the ground, which is that of the file `plan`. Throws UsageError
/// when `table` is empty, DataError when it cannot be read or is of other tiles.
std::vector<TileScores> read_scores(const std::string& table, const Ground& ground, const std::string& plan);

/// The plan of a file, its scores and its selection. Throws as read_scores, likewise for the others; DataError when the
/// scores or the selection are of another plan.
StageFiles read_stage_files(const std::string& plan, const StageFileOptions& options);

/// A folder that `prepare` wrote stands for the plan in it.
std::filesystem::path plan_of(const std::string& input);

/// Files that are not named are tiles.csv and selection.json beside the plan.
StageFileOptions stage_files_beside(const std::filesystem::path& plan, StageFileOptions options);

/// The map that is named, or map.gpkg beside the plan. Throws as need_file.
std::filesystem::path map_beside(const std::filesystem::path& plan, const std::string& named);

/// The maps that frames are matched on: `map`, and those of --also-map. Throws UsageError where one file is named
/// twice, for it would be asked twice, each time at its share of the rate; as need_file.
std::vector<std::filesystem::path> asked_maps(const std::filesystem::path& map, const std::vector<std::string>& also);

/// Throws IntegrityError where a further map is for another camera than the first (check_purpose()).
void check_one_camera(std::span<const MapReader> maps);

/// open_unverified_maps() of what asked_maps() gave. Throws as check_one_camera of several.
OpenMaps open_asked_maps(const std::vector<std::filesystem::path>& maps);

/// Of the maps: those that cannot be read, those of several that hold nothing where any of the frames looked, and
/// several that contradict each other.
std::vector<std::string> warnings_of_maps(std::span<const FrameMatch> matches,
                                          const std::vector<std::filesystem::path>& maps);

/// What is to be said of flights whose frames show the raster `world`: that it is the very imagery that a further one
/// of the `maps` was made of, by its digest, and so no other date of it. Throws UsageError where it is that of the
/// first, whose frames would be found nearly all, and taken for frames of another date; DataError as input_dataset.
std::vector<std::string> notes_of_world(const std::string& world, const std::vector<std::filesystem::path>& maps);

/// What is to be said beside numbers of flights on several maps that are held against P; "" of one map.
std::string several_maps_note(const std::vector<std::filesystem::path>& maps);

}  // namespace pilotage
