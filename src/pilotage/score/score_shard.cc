#include "pilotage/score/score_shard.h"

#include <iterator>

#include <nlohmann/json.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/file_digest.h"
#include "pilotage/base/json_object.h"
#include "pilotage/base/options_json.h"
#include "pilotage/base/output_file.h"
#include "pilotage/ground/tile_table.h"

namespace pilotage {
namespace {

constexpr std::string_view kMagic = "pilotage-shard ";
constexpr std::string_view kVersion = "2";
constexpr std::size_t kDigestChars = 64;
constexpr std::uintmax_t kMostBytes = std::uintmax_t{1} << 36;

}  // namespace

std::string shard_file_name(const Shard& shard) {
  const std::string count = std::to_string(shard.count);
  std::string number = std::to_string(shard.number);
  number.insert(0, count.size() - std::min(count.size(), number.size()), '0');
  return "scores-" + number + "-of-" + count + ".shard";
}

std::string score_shard_to_bytes(const ScoreShard& shard) {
  const nlohmann::ordered_json header{
      {"shard", shard.shard.number}, {"shards", shard.shard.count}, {"tiles", shard.rows.size()}, {"run", shard.run}};
  std::string bytes{kMagic};
  bytes += kVersion;
  bytes += '\n';
  bytes += header.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
  bytes += '\n';
  bytes += tile_table_to_csv(shard.rows);
  return bytes + bytes_digest(bytes);
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
  const std::int64_t tiles = header.integer("tiles", 0);
  shard.run = header.value("run");
  header.finish();
  shard.rows = tile_table_from_csv(name, content.substr(end_of_header + 1));
  if (std::ssize(shard.rows) != tiles) {
    throw DataError(name + ": has " + std::to_string(shard.rows.size()) + " tiles, its header says " +
                    std::to_string(tiles));
  }
  return shard;
}

ScoreShard read_score_shard(const std::string& file) {
  return score_shard_from_bytes(file, read_file(file, kMostBytes));
}

}  // namespace pilotage
