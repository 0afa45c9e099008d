#include "pilotage/score/run_shards.h"

#include <algorithm>
#include <charconv>
#include <string_view>
#include <tuple>

#include "pilotage/base/error.h"
#include "pilotage/base/text.h"

namespace pilotage {
namespace {

constexpr const char* kGrammar = "NUMBER/COUNT (3/16 is the third of 16) or auto/COUNT";

std::optional<std::int64_t> parse_count(std::string_view text) {
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

/// A variable that schedulers set in each task of an array, and the number it gives to the first one.
struct TaskIndex {
  const char* variable;
  std::int64_t first;
};
constexpr TaskIndex kTaskIndices[] = {
    {"SLURM_ARRAY_TASK_ID", 1}, {"JOB_COMPLETION_INDEX", 0}, {"AWS_BATCH_JOB_ARRAY_INDEX", 0}};

std::int64_t number_from_scheduler(std::int64_t count, const Environment& environment) {
  std::vector<std::string> found;
  std::int64_t number = 0;
  for (const TaskIndex& index : kTaskIndices) {
    const std::optional<std::string> text = environment(index.variable);
    if (!text) continue;
    found.emplace_back(index.variable);
    const std::optional<std::int64_t> value = parse_count(*text);
    if (!value || *value < index.first || *value - index.first >= count) {
      throw UsageError(std::string(index.variable) + " = \"" + *text + "\" is outside [" + std::to_string(index.first) +
                       ", " + std::to_string(count - 1 + index.first) + "], the numbers of " + std::to_string(count) +
                       " shards");
    }
    number = *value - index.first + 1;
  }
  if (found.empty()) {
    throw UsageError("shard = \"auto/" + std::to_string(count) +
                     "\": no scheduler says which: none of SLURM_ARRAY_TASK_ID, JOB_COMPLETION_INDEX and "
                     "AWS_BATCH_JOB_ARRAY_INDEX is set");
  }
  if (found.size() > 1) throw UsageError("shard = \"auto\": " + join(found, " and ") + " are set; give the number");
  return number;
}

/// Ranks [begin, end) of a shard among `tiles` tiles.
std::pair<std::int64_t, std::int64_t> ranks(std::int64_t tiles, const Shard& shard) {
  if (shard.count < 1 || shard.count > kMostShards || shard.number < 1 || shard.number > shard.count) {
    throw UsageError("shard " + std::to_string(shard.number) + "/" + std::to_string(shard.count) + " is not 1 … " +
                     std::to_string(shard.count));
  }
  if (shard.count > tiles) {
    throw UsageError(std::to_string(shard.count) + " shards of " + std::to_string(tiles) +
                     " tiles: at most one shard for each tile");
  }
  // Whole tiles and the rest apart, so that no product overflows.
  const std::int64_t whole = tiles / shard.count;
  const std::int64_t rest = tiles % shard.count;
  const auto begin = [&](std::int64_t number) { return whole * number + rest * number / shard.count; };
  return {begin(shard.number - 1), begin(shard.number)};
}

}  // namespace

Shard parse_shard(const std::string& text, const Environment& environment) {
  const std::size_t slash = text.find('/');
  const std::string_view before = std::string_view(text).substr(0, slash);
  const std::optional<std::int64_t> count =
      slash == std::string::npos ? std::nullopt : parse_count(std::string_view(text).substr(slash + 1));
  if (!count) throw UsageError("shard = \"" + text + "\" is not " + kGrammar);
  if (*count < 1 || *count > kMostShards) {
    throw UsageError("shard = \"" + text + "\": a count of " + std::to_string(*count) + " is outside [1, " +
                     std::to_string(kMostShards) + "]");
  }
  if (before == "auto") return {number_from_scheduler(*count, environment), *count};
  const std::optional<std::int64_t> number = parse_count(before);
  if (!number) throw UsageError("shard = \"" + text + "\" is not " + kGrammar);
  if (*number < 1 || *number > *count) {
    throw UsageError("shard = \"" + text + "\": " + std::to_string(*number) + " is outside [1, " +
                     std::to_string(*count) + "]");
  }
  return {*number, *count};
}

std::vector<ShardTile> shard_tiles(const TileMatrix& matrix, const Shard& shard) {
  const std::int64_t width = matrix.matrix_width();
  const std::int64_t height = matrix.matrix_height();
  const auto [begin, end] = ranks(matrix.tile_count(), shard);
  std::vector<ShardTile> tiles;
  tiles.reserve(static_cast<std::size_t>(end - begin));
  for (std::int64_t rank = begin; rank < end; ++rank) {
    const std::int64_t first_column = rank / (kShardColumns * height) * kShardColumns;
    const std::int64_t columns = std::min(kShardColumns, width - first_column);
    const std::int64_t in_group = rank - first_column * height;
    const std::int64_t row = in_group / columns;
    const std::int64_t column = first_column + in_group % columns;
    tiles.push_back({row * width + column, matrix.level, column, row});
  }
  return tiles;
}

std::vector<ShardTile> shard_tiles(const std::vector<GroundTile>& tiles, const Shard& shard) {
  std::vector<ShardTile> all;
  all.reserve(tiles.size());
  for (const GroundTile& tile : tiles) {
    all.push_back({static_cast<std::int64_t>(all.size()), tile.level, tile.column, tile.row});
  }
  const auto key = [](const ShardTile& tile) {
    return std::tuple(tile.level, tile.column / kShardColumns, tile.row, tile.column);
  };
  std::sort(all.begin(), all.end(), [&](const ShardTile& a, const ShardTile& b) { return key(a) < key(b); });
  const auto [begin, end] = ranks(static_cast<std::int64_t>(all.size()), shard);
  return {all.begin() + begin, all.begin() + end};
}

std::vector<ShardPart> shard_parts(const std::vector<ShardTile>& tiles) {
  std::vector<ShardPart> parts;
  for (const ShardTile& tile : tiles) {
    const bool same = !parts.empty() && parts.back().level == tile.level &&
                      parts.back().first_column / kShardColumns == tile.column / kShardColumns;
    if (!same) parts.push_back({tile.level, tile.column, tile.column, tile.row, tile.row, 0});
    ShardPart& part = parts.back();
    part.first_column = std::min(part.first_column, tile.column);
    part.last_column = std::max(part.last_column, tile.column);
    part.last_row = tile.row;
    ++part.tiles;
  }
  return parts;
}

std::string number_list(const std::vector<std::int64_t>& numbers) {
  std::vector<std::string> parts;
  for (std::size_t first = 0; first < numbers.size();) {
    std::size_t last = first;
    while (last + 1 < numbers.size() && numbers[last + 1] == numbers[last] + 1) ++last;
    parts.push_back(std::to_string(numbers[first]) + (last > first ? "-" + std::to_string(numbers[last]) : ""));
    first = last + 1;
  }
  return join(parts, ",");
}

}  // namespace pilotage
