#include "pilotage/score/merge_shards.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <optional>

#include <nlohmann/json.hpp>

#include "pilotage/base/error.h"
#include "pilotage/score/describe_run.h"
#include "pilotage/score/score_shard.h"

namespace pilotage {
namespace {

/// What the first shard says, and all others must.
struct Expected {
  std::string file;
  nlohmann::ordered_json run;
  std::int64_t count;
};

void check_same_run(const std::string& file, const ScoreShard& shard, const Expected& expected) {
  const std::string difference = run_difference(shard.run, expected.run);
  if (!difference.empty()) {
    throw DataError(file + ": is of another run than " + expected.file + " (" + difference + ")");
  }
  if (shard.shard.count != expected.count) {
    throw DataError(file + ": is one of " + std::to_string(shard.shard.count) + " shards, " + expected.file +
                    " one of " + std::to_string(expected.count));
  }
}

std::int64_t id_of_place(const ScoreRun& run, std::int64_t place) {
  return run.flight ? run.ground.tiles[static_cast<std::size_t>(place)].tile_id : place;
}

/// Moves the scores to their places.
void place_scores(const std::string& file, ScoreShard& shard, const ScoreRun& run, std::vector<TileScores>& scores) {
  std::vector<std::int64_t> places;
  for (const ShardTile& tile : shard_tiles(run, shard.shard)) places.push_back(tile.place);
  std::sort(places.begin(), places.end());
  if (places.size() != shard.rows.size()) {
    throw DataError(file + ": has " + std::to_string(shard.rows.size()) + " tiles, expected " +
                    std::to_string(places.size()));
  }
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (shard.rows[i].tile.tile_id != id_of_place(run, places[i])) {
      throw DataError(file + ": has tile " + std::to_string(shard.rows[i].tile.tile_id) + ", expected " +
                      std::to_string(id_of_place(run, places[i])));
    }
    scores[static_cast<std::size_t>(places[i])] = std::move(shard.rows[i].score);
  }
}

}  // namespace

std::vector<std::string> shard_files(const std::vector<std::string>& names) {
  namespace fs = std::filesystem;
  std::vector<std::string> files;
  for (const std::string& name : names) {
    std::error_code error;
    if (!fs::is_directory(name, error)) {
      files.push_back(name);
      continue;
    }
    std::vector<std::string> inside;
    for (const fs::directory_entry& entry : fs::directory_iterator(name, error)) {
      const std::string file_name = entry.path().filename().string();
      if (file_name.ends_with(".shard") && !file_name.starts_with(".")) inside.push_back(entry.path().string());
    }
    if (error) throw DataError(name + ": cannot be read: " + error.message());
    if (inside.empty()) throw DataError(name + ": holds no shards (*.shard)");
    std::sort(inside.begin(), inside.end());
    files.insert(files.end(), inside.begin(), inside.end());
  }
  return files;
}

MergedShards read_shards(const std::vector<std::string>& files, const std::string& software_version,
                         const Progress& progress) {
  MergedShards merged;
  std::optional<Expected> expected;
  std::map<std::int64_t, std::string> file_of_number;
  for (std::size_t i = 0; i < files.size(); ++i) {
    report_progress(progress, "reading shards", static_cast<std::int64_t>(i), static_cast<std::int64_t>(files.size()));
    ScoreShard shard = read_score_shard(files[i]);
    if (!expected) {
      expected = {files[i], shard.run, shard.shard.count};
      merged.count = shard.shard.count;
      merged.run = open_described_run(files[i], shard.run);
      const std::string difference = run_difference(shard.run, describe_run(merged.run, software_version, progress));
      if (!difference.empty()) {
        throw DataError(files[i] + ": what it was made of is not what is here now (" + difference + ")");
      }
      merged.scores.resize(static_cast<std::size_t>(tile_count(merged.run)));
    }
    check_same_run(files[i], shard, *expected);
    const auto [known, is_new] = file_of_number.try_emplace(shard.shard.number, files[i]);
    if (!is_new) {
      throw DataError(files[i] + ": is shard " + std::to_string(shard.shard.number) + ", and so is " + known->second);
    }
    place_scores(files[i], shard, merged.run, merged.scores);
  }
  for (std::int64_t number = 1; number <= merged.count; ++number) {
    if (!file_of_number.contains(number)) merged.missing.push_back(number);
  }
  return merged;
}

}  // namespace pilotage
