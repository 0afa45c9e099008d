#include "pilotage/gis/pmtiles.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <iterator>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/json_object.h"
#include "pilotage/base/output_file.h"
#include "pilotage/base/text.h"
#include "pilotage/mapdb/sqlite.h"

namespace pilotage {
namespace {

constexpr int kMaxTileBytes = 16 << 20;
constexpr std::uint64_t kHeaderBytes = 127;
constexpr std::uint64_t kRootBytes = 16'384 - kHeaderBytes;  // header and root directory come in the first 16 KiB
constexpr std::size_t kEntriesOfLeaf = 4096;
constexpr std::uint8_t kNotCompressed = 1;
constexpr std::uint8_t kJpeg = 3;

/// A line of a directory: a tile, or with `run` 0 a directory of tiles from this one on.
struct Entry {
  std::uint64_t id = 0;
  std::uint64_t offset = 0;
  std::uint64_t length = 0;
  std::uint64_t run = 1;
};

struct Tile {
  std::uint64_t id = 0;
  int zoom = 0;
  std::int64_t column = 0;
  std::int64_t row_from_south = 0;
};

/// Little-endian, seven bits a byte, the lowest first.
void put_varint(std::uint64_t value, std::string& bytes) {
  while (value >= 0x80) {
    bytes.push_back(static_cast<char>((value & 0x7F) | 0x80));
    value >>= 7;
  }
  bytes.push_back(static_cast<char>(value));
}

template <class Integer>
void put_fixed(Integer value, std::string& bytes) {
  for (std::size_t i = 0; i < sizeof(Integer); ++i) {
    bytes.push_back(static_cast<char>((static_cast<std::uint64_t>(value) >> (8 * i)) & 0xFF));
  }
}

std::string directory_of(const std::vector<Entry>& entries) {
  std::string bytes;
  put_varint(entries.size(), bytes);
  std::uint64_t id = 0;
  for (const Entry& entry : entries) {
    put_varint(entry.id - id, bytes);
    id = entry.id;
  }
  for (const Entry& entry : entries) put_varint(entry.run, bytes);
  for (const Entry& entry : entries) put_varint(entry.length, bytes);
  std::uint64_t next = 0;
  for (const Entry& entry : entries) {
    put_varint(entry.offset == next && &entry != &entries.front() ? 0 : entry.offset + 1, bytes);
    next = entry.offset + entry.length;
  }
  return bytes;
}

/// The directories that lead to the tiles.
struct Directories {
  std::string root;
  std::string leaves;
};

Directories directories_of(const std::vector<Entry>& tiles) {
  Directories directories{directory_of(tiles), ""};
  for (std::size_t size = kEntriesOfLeaf; directories.root.size() > kRootBytes; size *= 2) {
    std::vector<Entry> root;
    directories.leaves.clear();
    for (std::size_t begin = 0; begin < tiles.size(); begin += size) {
      const auto first = tiles.begin() + static_cast<std::ptrdiff_t>(begin);
      const std::string leaf = directory_of(
          {first, first + std::min<std::ptrdiff_t>(static_cast<std::ptrdiff_t>(size), tiles.end() - first)});
      root.push_back({first->id, directories.leaves.size(), leaf.size(), 0});
      directories.leaves += leaf;
    }
    directories.root = directory_of(root);
  }
  return directories;
}

std::map<std::string, std::string> read_metadata(const Database& database) {
  std::map<std::string, std::string> metadata;
  Statement rows = database.prepare("SELECT name, value FROM metadata", "metadata");
  while (rows.step()) metadata[std::string(rows.text(0))] = rows.text(1);
  return metadata;
}

/// In degrees · 1e7, as the header has them.
std::vector<std::int32_t> degrees_e7(const std::string& numbers, std::size_t count, const std::string& name) {
  std::vector<std::int32_t> values;
  std::string_view rest = numbers;
  while (!rest.empty() && values.size() < count) {
    const std::size_t comma = rest.find(',');
    const auto number = parse_number(rest.substr(0, comma));
    if (!number || std::abs(*number) > 180) break;
    values.push_back(static_cast<std::int32_t>(std::lround(*number * 1e7)));
    rest.remove_prefix(comma == std::string_view::npos ? rest.size() : comma + 1);
  }
  if (values.size() != count) throw DataError(name + ": its metadata have no place: \"" + numbers + "\"");
  return values;
}

/// Numbers and lengths of all tiles, in the order of the archive.
std::vector<Tile> list_tiles(const Database& database, std::vector<Entry>& entries) {
  std::vector<std::pair<Tile, std::uint64_t>> found;
  Statement rows = database.prepare("SELECT zoom_level, tile_column, tile_row, length(tile_data) FROM tiles", "tiles");
  while (rows.step()) {
    Tile tile;
    tile.zoom = rows.integer(0, 0, 31);
    const int last = static_cast<int>((std::int64_t{1} << tile.zoom) - 1);
    tile.column = rows.integer(1, 0, last);
    tile.row_from_south = rows.integer(2, 0, last);
    tile.id = pmtiles_id(tile.zoom, tile.column, last - tile.row_from_south);
    found.emplace_back(tile, static_cast<std::uint64_t>(rows.integer(3, 1, kMaxTileBytes)));
  }
  if (found.empty()) throw DataError(database.name() + ": holds no tile");
  std::sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.first.id < b.first.id; });
  std::vector<Tile> tiles;
  std::uint64_t offset = 0;
  for (const auto& [tile, length] : found) {
    tiles.push_back(tile);
    entries.push_back({tile.id, offset, length, 1});
    offset += length;
  }
  return tiles;
}

}  // namespace

std::uint64_t pmtiles_id(int zoom, std::int64_t column, std::int64_t row) {
  std::uint64_t id = 0;
  for (int level = 0; level < zoom; ++level) id += std::uint64_t{1} << (2 * level);
  auto x = static_cast<std::uint64_t>(column);
  auto y = static_cast<std::uint64_t>(row);
  for (std::uint64_t half = (std::uint64_t{1} << zoom) / 2; half > 0; half /= 2) {
    const bool right = (x & half) != 0;
    const bool lower = (y & half) != 0;
    id += half * half * (right ? (lower ? 2U : 3U) : (lower ? 1U : 0U));
    if (lower) continue;  // the curve of the two upper quarters is mirrored, and turned
    if (right) {
      x = half - 1 - (x & (half - 1));
      y = half - 1 - (y & (half - 1));
    }
    std::swap(x, y);
  }
  return id;
}

void write_pmtiles(const std::filesystem::path& path, const std::filesystem::path& mbtiles, bool overwrite) {
  const Database database = Database::open_untrusted(mbtiles, kMaxTileBytes);
  std::vector<Entry> entries;
  const std::vector<Tile> tiles = list_tiles(database, entries);
  const std::map<std::string, std::string> metadata = read_metadata(database);
  const auto said = [&](const std::string& name) {
    const auto found = metadata.find(name);
    return found == metadata.end() ? std::string() : found->second;
  };
  if (said("format") != "jpg") {
    throw DataError(database.name() + ": its tiles are not JPEG (format \"" + said("format") + "\")");
  }
  const std::vector<std::int32_t> bounds = degrees_e7(said("bounds"), 4, database.name());
  const std::vector<std::int32_t> center = degrees_e7(said("center"), 2, database.name());
  const auto [coarsest, finest] =
      std::minmax_element(tiles.begin(), tiles.end(), [](const Tile& a, const Tile& b) { return a.zoom < b.zoom; });
  nlohmann::ordered_json words = nlohmann::ordered_json::object();
  for (const char* name : {"name", "description", "attribution", "type"}) {
    if (!said(name).empty()) words[name] = said(name);
  }
  const std::string text = json_text(words);
  const Directories directories = directories_of(entries);

  std::string header = "PMTiles\x03";
  std::uint64_t at = kHeaderBytes;
  for (const std::uint64_t length :
       {static_cast<std::uint64_t>(directories.root.size()), static_cast<std::uint64_t>(text.size()),
        static_cast<std::uint64_t>(directories.leaves.size()), entries.back().offset + entries.back().length}) {
    put_fixed(at, header);
    put_fixed(length, header);
    at += length;
  }
  // Addressed tiles, entries and contents: no two entries share a content.
  for (int i = 0; i < 3; ++i) put_fixed(static_cast<std::uint64_t>(entries.size()), header);
  for (const std::uint8_t byte : {std::uint8_t{1},  // clustered
                                  kNotCompressed, kNotCompressed, kJpeg, static_cast<std::uint8_t>(coarsest->zoom),
                                  static_cast<std::uint8_t>(finest->zoom)}) {
    put_fixed(byte, header);
  }
  for (const std::int32_t corner : bounds) put_fixed(corner, header);
  put_fixed(static_cast<std::uint8_t>(coarsest->zoom), header);
  for (const std::int32_t degrees : center) put_fixed(degrees, header);

  OutputFile output(path, overwrite);
  std::ofstream file(output.temporary_path(), std::ios::binary);
  file << header << directories.root << text << directories.leaves;
  Statement read = database.prepare(
      "SELECT tile_data FROM tiles WHERE zoom_level = ? AND tile_column = ? AND tile_row = ?", "tiles");
  for (const Tile& tile : tiles) {
    const StatementScope scope(read);
    read.bind(1, std::int64_t{tile.zoom}).bind(2, tile.column).bind(3, tile.row_from_south);
    if (!read.step()) throw DataError(database.name() + ": a tile that was there is gone");
    const std::span<const std::uint8_t> bytes = read.blob(0);
    file.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  }
  file.close();
  if (!file) throw DataError(path.string() + ": cannot be written");
  output.commit();
}

}  // namespace pilotage
