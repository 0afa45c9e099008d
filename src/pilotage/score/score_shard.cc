#include "pilotage/score/score_shard.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "pilotage/base/error.h"
#include "pilotage/base/file_digest.h"
#include "pilotage/base/json_object.h"
#include "pilotage/base/options_json.h"
#include "pilotage/base/output_file.h"
#include "pilotage/ground/tile_table.h"
#include "pilotage/mapdb/byte_order.h"

namespace pilotage {
namespace {

constexpr std::string_view kMagic = "pilotage-shard ";
constexpr std::string_view kVersion = "1";
constexpr std::size_t kDigestChars = 64;
constexpr std::size_t kFixedBytes = 8 + 1 + 8;  // of a tile: id, status, valid fraction
constexpr std::uintmax_t kMostBytes = std::uintmax_t{1} << 36;

bool is_measured(const Measure& measure, const std::vector<TileScore>& scores) {
  return std::any_of(scores.begin(), scores.end(),
                     [&](const TileScore& score) { return !std::isnan(measure.get(score)); });
}

/// The bytes behind the header: checked against the number of tiles and columns, then read one array after the other.
class Arrays {
 public:
  Arrays(std::string name, std::string_view bytes, std::size_t tiles, std::size_t columns)
      : name_(std::move(name)), left_(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()) {
    const std::size_t per_tile = kFixedBytes + 8 * columns;
    if (bytes.size() / per_tile != tiles || bytes.size() % per_tile != 0) {
      throw DataError(name_ + ": has " + std::to_string(bytes.size()) + " bytes of scores, expected " +
                      std::to_string(tiles) + " x " + std::to_string(per_tile));
    }
  }
  std::int64_t take_integer() { return static_cast<std::int64_t>(read_le<std::uint64_t>(take(8))); }
  std::uint8_t take_byte() { return *take(1); }
  double take_double() { return read_le_double(take(8)); }

 private:
  const std::uint8_t* take(std::size_t count) {
    const std::uint8_t* bytes = left_.data();
    left_ = left_.subspan(count);
    return bytes;
  }

  std::string name_;
  std::span<const std::uint8_t> left_;
};

std::vector<const Measure*> read_columns(JsonObject& header) {
  std::vector<const Measure*> columns;
  for (const std::string& name : header.texts("columns")) {
    const Measure* column = find_measure(name);
    if (column == nullptr || std::find(columns.begin(), columns.end(), column) != columns.end()) {
      throw DataError(header.path("columns") + ": \"" + name.substr(0, 40) + "\" is not known, or stands twice");
    }
    columns.push_back(column);
  }
  return columns;
}

void read_scores(const std::string& name, Arrays& arrays, const std::vector<const Measure*>& columns,
                 std::vector<TileScore>& scores) {
  std::int64_t last_id = -1;
  for (TileScore& score : scores) {
    score.tile_id = arrays.take_integer();
    if (score.tile_id <= last_id) {
      throw DataError(name + ": tile_id " + std::to_string(score.tile_id) + " does not follow " +
                      std::to_string(last_id));
    }
    last_id = score.tile_id;
  }
  for (TileScore& score : scores) {
    const std::uint8_t status = arrays.take_byte();
    if (status > static_cast<std::uint8_t>(TileStatus::kFlat)) {
      throw DataError(name + ": tile " + std::to_string(score.tile_id) + ": status " + std::to_string(status) +
                      " is outside [0, 2]");
    }
    score.status = static_cast<TileStatus>(status);
  }
  for (TileScore& score : scores) {
    score.valid_fraction = arrays.take_double();
    if (!(score.valid_fraction >= 0 && score.valid_fraction <= 1)) {
      throw DataError(name + ": tile " + std::to_string(score.tile_id) + ": valid_fraction is outside [0, 1]");
    }
  }
  for (const Measure* column : columns) {
    for (TileScore& score : scores) column->set(score, arrays.take_double());
  }
}

}  // namespace

std::string shard_file_name(const Shard& shard) {
  const std::string count = std::to_string(shard.count);
  std::string number = std::to_string(shard.number);
  number.insert(0, count.size() - std::min(count.size(), number.size()), '0');
  return "scores-" + number + "-of-" + count + ".shard";
}

std::string score_shard_to_bytes(const ScoreShard& shard) {
  std::vector<const Measure*> columns;
  nlohmann::ordered_json names = nlohmann::ordered_json::array();
  for (const Measure& column : measures()) {
    if (!is_measured(column, shard.scores)) continue;
    columns.push_back(&column);
    names.push_back(column.name);
  }
  const nlohmann::ordered_json header{{"shard", shard.shard.number},
                                      {"shards", shard.shard.count},
                                      {"tiles", shard.scores.size()},
                                      {"columns", names},
                                      {"run", shard.run}};
  std::vector<std::uint8_t> bytes;
  const std::string text = header.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
  bytes.reserve(text.size() + 128 + shard.scores.size() * (kFixedBytes + 8 * columns.size()));
  append_text(bytes, kMagic);
  append_text(bytes, kVersion);
  append_text(bytes, "\n");
  append_text(bytes, text);
  append_text(bytes, "\n");
  for (const TileScore& score : shard.scores) append_le(bytes, score.tile_id);
  for (const TileScore& score : shard.scores) append_le(bytes, static_cast<std::uint8_t>(score.status));
  for (const TileScore& score : shard.scores) append_le(bytes, score.valid_fraction);
  for (const Measure* column : columns) {
    for (const TileScore& score : shard.scores) append_le(bytes, column->get(score));
  }
  std::string file(bytes.begin(), bytes.end());
  return file + bytes_digest(file);
}

ScoreShard score_shard_from_bytes(const std::string& name, std::string_view bytes) {
  if (!bytes.starts_with(kMagic)) throw DataError(name + ": is no shard of scores");
  const std::string_view version = bytes.substr(kMagic.size(), bytes.substr(kMagic.size(), 20).find('\n'));
  if (version != kVersion) {
    throw DataError(name + ": is a shard of version \"" + std::string(version.substr(0, 20)) +
                    "\"; this program reads version " + std::string(kVersion));
  }
  const std::size_t begin = kMagic.size() + kVersion.size() + 1;
  if (bytes.size() < begin + kDigestChars ||
      bytes_digest(bytes.substr(0, bytes.size() - kDigestChars)) != bytes.substr(bytes.size() - kDigestChars)) {
    throw IntegrityError(name + ": is truncated or was changed: its digest is wrong");
  }
  const std::string_view content = bytes.substr(begin, bytes.size() - begin - kDigestChars);
  const std::size_t end_of_header = content.find('\n');
  if (end_of_header == std::string_view::npos) throw DataError(name + ": has no header");
  const nlohmann::ordered_json json = parse_json(name, content.substr(0, end_of_header));
  JsonObject header(json, name);
  ScoreShard shard;
  shard.shard.count = header.integer("shards", 1, kMostShards);
  shard.shard.number = header.integer("shard", 1, shard.shard.count);
  const auto tiles = static_cast<std::size_t>(header.integer("tiles", 0, static_cast<std::int64_t>(kMostBytes)));
  const std::vector<const Measure*> columns = read_columns(header);
  shard.run = header.value("run");
  header.finish();
  Arrays arrays(name, content.substr(end_of_header + 1), tiles, columns.size());
  shard.scores.resize(tiles);
  read_scores(name, arrays, columns, shard.scores);
  return shard;
}

ScoreShard read_score_shard(const std::string& file) {
  return score_shard_from_bytes(file, read_file(file, kMostBytes));
}

}  // namespace pilotage
