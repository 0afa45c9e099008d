#include "stage_files.h"

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>

#include "pilotage/base/error.h"
#include "pilotage/base/output_file.h"
#include "pilotage/base/text.h"
#include "pilotage/ground/score_table.h"
#include "pilotage/mapdb/map_purpose.h"
#include "pilotage/mission/input_files.h"
#include "pilotage/mission/plan_file.h"
#include "pilotage/mission/selection_file.h"

namespace pilotage {
namespace {

/// Whether imagery of this digest is among what a map says that it was made of.
bool is_made_of(const MapReader& map, const std::string& digest) {
  for (int index = 0;; ++index) {
    const std::string key = "input." + std::to_string(index) + ".";
    const auto role = map.info().find(key + "role");
    if (!role) return false;
    if (*role == "imagery" && !digest.empty() && map.info().find(key + "digest") == digest) return true;
  }
}

}  // namespace

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

std::vector<std::filesystem::path> asked_maps(const std::filesystem::path& map, const std::vector<std::string>& also) {
  std::vector<std::filesystem::path> maps{map};
  for (const std::string& path : also) {
    refuse_empty("--also-map", path);
    need_file(path, "build` or `pilotage prepare");
    for (const std::filesystem::path& known : maps) {
      std::error_code ignored;
      if (!std::filesystem::equivalent(known, path, ignored)) continue;
      throw UsageError("--also-map " + path + " is the same file as " + known.string() +
                       ": it would be asked twice, each time at its share of the rate of false fixes");
    }
    maps.emplace_back(path);
  }
  return maps;
}

void check_one_camera(std::span<const MapReader> maps) {
  MapRequirements required;
  required.camera = maps.front().camera();
  for (const MapReader& map : maps.subspan(1)) {
    try {
      check_purpose(map, required);
    } catch (const IntegrityError&) {
      throw IntegrityError(
          map.name() + ": is for another camera than " + maps.front().name() +
          "; frames are matched on all maps, so give maps for one camera (or, to match, --allow-other-camera)");
    }
  }
}

OpenMaps open_asked_maps(const std::vector<std::filesystem::path>& maps) {
  OpenMaps open_maps = open_unverified_maps(maps);
  if (maps.size() > 1) check_one_camera(open_maps());
  return open_maps;
}

std::vector<std::string> notes_of_world(const std::string& world, const std::vector<std::filesystem::path>& maps) {
  if (world.empty()) return {};
  const std::string digest = input_dataset("imagery", world, "").digest;
  std::vector<std::string> notes;
  for (std::size_t i = 0; i < maps.size(); ++i) {
    if (!is_made_of(MapReader::open_unverified(maps[i]), digest)) continue;
    if (i == 0) {
      throw UsageError("--world " + world + ": is the imagery that " + maps[i].string() +
                       " was made of, and no other date; without --world it is changed as another day may look");
    }
    notes.push_back("optimistic: frames show the very imagery that " + maps[i].string() + " was made of");
  }
  return notes;
}

std::vector<std::string> warnings_of_maps(std::span<const FrameMatch> matches,
                                          const std::vector<std::filesystem::path>& maps) {
  std::vector<std::string> warnings;
  for (std::size_t i = 0; i < maps.size(); ++i) {
    const auto count = [&](auto is_counted) {
      return std::count_if(matches.begin(), matches.end(), [&](const FrameMatch& match) {
        const std::vector<MatchStatus>& statuses = match.result.map_statuses;
        return i < statuses.size() && is_counted(statuses[i]);
      });
    };
    const auto asked = count([](MatchStatus) { return true; });
    const auto damaged = count([](MatchStatus status) { return status == MatchStatus::kMapUnreadable; });
    if (damaged > 0) {
      warnings.push_back(maps[i].string() + ": could not be read for " + std::to_string(damaged) + " of " +
                         std::to_string(asked) + " frames; pilotage verify says more");
    }
    const auto empty = count([](MatchStatus status) { return status == MatchStatus::kNoMap; });
    if (maps.size() > 1 && asked > 0 && empty == asked) {
      warnings.push_back(
          maps[i].string() +
          ": holds nothing where any frame looked; asking it costs evidence and time, and gives nothing");
    }
  }
  const auto fixes_of = [](const FrameMatch& match) {
    return std::count(match.result.map_statuses.begin(), match.result.map_statuses.end(), MatchStatus::kFix);
  };
  const auto shared =
      std::count_if(matches.begin(), matches.end(), [&](const auto& match) { return fixes_of(match) > 1; });
  const auto withdrawn = std::count_if(matches.begin(), matches.end(), [&](const FrameMatch& match) {
    return fixes_of(match) > 1 && match.result.status == MatchStatus::kAmbiguous;
  });
  if (10 * withdrawn > shared) {
    warnings.push_back("of " + std::to_string(shared) + " frames with fixes of several maps " +
                       std::to_string(withdrawn) +
                       " are ambiguous: do the maps lie on each other? pilotage audit compares their imagery");
  }
  return warnings;
}

std::string several_maps_note(const std::vector<std::filesystem::path>& maps) {
  if (maps.size() < 2) return "";
  std::vector<std::string> others;
  for (std::size_t i = 1; i < maps.size(); ++i) others.push_back(maps[i].string());
  return "frames are matched on " + maps.front().string() + " and on " + join(others, ", ") +
         "; P(correct fix) is of the first alone";
}

}  // namespace pilotage
