#include "pilotage/mapdb/map_delta_writer.h"

#include <algorithm>
#include <fstream>
#include <map>
#include <memory>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include <zstd.h>

#include "pilotage/base/error.h"
#include "pilotage/base/file_digest.h"
#include "pilotage/base/read_file.h"
#include "pilotage/mapdb/byte_order.h"
#include "pilotage/mapdb/map_delta_format.h"
#include "pilotage/mapdb/map_reader.h"
#include "pilotage/mapdb/map_schema.h"
#include "pilotage/mapdb/sqlite.h"
#include "pilotage/mapdb/trusted_signature.h"

namespace pilotage {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kPageBytes = 4096;
constexpr std::size_t kPagePointerBytes = 4;  // at the start of a page that goes on: where, which changes when it moves
constexpr int kCompressionLevel = 12;

/// Reads a file whose size must not change.
class MapBytes {
 public:
  explicit MapBytes(const fs::path& path) : path_(path), file_(path, std::ios::binary) {
    std::error_code error;
    size_ = fs::file_size(path, error);
    if (error || !file_) throw DataError(path.string() + ": cannot be read");
  }
  std::uint64_t size() const { return size_; }
  std::string read(std::uint64_t offset, std::uint64_t count) {
    std::string bytes(std::min(count, size_ - offset), '\0');
    file_.seekg(static_cast<std::streamoff>(offset));
    if (!file_.read(bytes.data(), static_cast<std::streamsize>(bytes.size()))) {
      throw DataError(path_.string() + ": cannot be read");
    }
    return bytes;
  }

 private:
  fs::path path_;
  std::ifstream file_;
  std::uint64_t size_ = 0;
};

std::uint64_t page_mark(std::string_view page) {
  const auto digest = blake2b_256(page.substr(std::min(page.size(), kPagePointerBytes)));
  return read_le<std::uint64_t>(digest.data());
}

/// Where the pages of the old map stand, by what is in them; of equal ones the first.
class OldPages {
 public:
  explicit OldPages(MapBytes& map) {
    for (std::uint64_t offset = 0; offset < map.size(); offset += kDeltaFrameBytes) {
      const std::string part = map.read(offset, kDeltaFrameBytes);
      for (std::size_t at = 0; at < part.size(); at += kPageBytes) {
        places_.emplace(page_mark(std::string_view(part).substr(at, kPageBytes)), (offset + at) / kPageBytes);
      }
    }
  }
  /// The first byte of the `window` bytes of the old map that hold the most pages of `part`; `otherwise` where none
  /// does.
  std::uint64_t best_window(std::string_view part, std::uint64_t window, std::uint64_t otherwise) const {
    std::vector<std::uint64_t> found;
    for (std::size_t at = 0; at < part.size(); at += kPageBytes) {
      const auto place = places_.find(page_mark(part.substr(at, kPageBytes)));
      if (place != places_.end()) found.push_back(place->second);
    }
    std::sort(found.begin(), found.end());
    std::uint64_t best = otherwise;
    std::size_t most = 0;
    std::size_t end = 0;
    for (std::size_t begin = 0; begin < found.size(); ++begin) {
      while (end < found.size() && found[end] < found[begin] + window / kPageBytes) ++end;
      if (end - begin > most) {
        most = end - begin;
        best = found[begin] * kPageBytes;
      }
    }
    return best;
  }

 private:
  std::unordered_map<std::uint64_t, std::uint64_t> places_;
};

struct FreeCompression {
  void operator()(ZSTD_CCtx* context) const { ZSTD_freeCCtx(context); }
};

class Compressor {
 public:
  Compressor() : context_(ZSTD_createCCtx()) {
    if (context_ == nullptr) throw DataError("zstd cannot be started");
    set(ZSTD_c_compressionLevel, kCompressionLevel);
    set(ZSTD_c_windowLog, kDeltaWindowLog);
    set(ZSTD_c_enableLongDistanceMatching, 1);
  }
  std::string compress(std::string_view part, std::string_view window) {
    std::string bytes(ZSTD_compressBound(part.size()), '\0');
    ZSTD_CCtx_refPrefix(context_.get(), window.data(), window.size());
    const std::size_t made = ZSTD_compress2(context_.get(), bytes.data(), bytes.size(), part.data(), part.size());
    if (ZSTD_isError(made)) throw DataError(std::string("a delta cannot be compressed: ") + ZSTD_getErrorName(made));
    bytes.resize(made);
    return bytes;
  }

 private:
  void set(ZSTD_cParameter parameter, int value) {
    if (ZSTD_isError(ZSTD_CCtx_setParameter(context_.get(), parameter, value))) {
      throw DataError("zstd does not take the parameters of a delta");
    }
  }
  std::unique_ptr<ZSTD_CCtx, FreeCompression> context_;
};

void append_digest(std::vector<std::uint8_t>& bytes, const std::string& hex) {
  for (std::size_t i = 0; i < hex.size(); i += 2) {
    bytes.push_back(static_cast<std::uint8_t>(std::stoi(hex.substr(i, 2), nullptr, 16)));
  }
}

/// Where a tile lies and in what pixels → what is stored of it, without its number and its place in the grid: a grid
/// that begins elsewhere at whole tiles has the same ones.
using StoredTiles = std::map<std::string, std::string>;

StoredTiles stored_tiles(const Database& map) {
  StoredTiles stored;
  for (const auto& [table, columns] :
       {std::pair("pilotage_descriptors",
                  "s.descriptor_bytes || ' ' || quote(s.ground_base_m), s.keypoints, s.descriptors"),
        std::pair("pilotage_chips", "s.encoding, s.data, x''")}) {
    if (map.query_integer(std::string("SELECT count(*) FROM sqlite_schema WHERE name = '") + table + "'") == 0)
      continue;
    Statement rows = map.prepare(
        std::string("SELECT format('%.6f %.6f %d ', t.min_x_m, t.min_y_m, l.tile_size_px) || quote(l.gsd_m), "
                    "s.window_width_px || ' ' || s.window_height_px || ' ' || ") +
            columns + " FROM " + table + " s JOIN tiles t USING (tile_id) JOIN pilotage_levels l ON l.level = s.level",
        table);
    while (rows.step()) {
      std::string& of_tile = stored[std::string(rows.text(0))];
      of_tile.append(rows.text(1));
      for (const int column : {2, 3}) {
        const auto bytes = rows.blob(column);
        of_tile.append(bytes_digest({reinterpret_cast<const char*>(bytes.data()), bytes.size()}));
      }
    }
  }
  return stored;
}

std::string crs_of(const Database& map) {
  Statement rows = map.prepare("SELECT srs_id, definition FROM gpkg_spatial_ref_sys ORDER BY srs_id", "the CRS");
  std::string crs;
  while (rows.step()) crs += std::to_string(rows.integer(0)) + " " + std::string(rows.text(1)) + "\n";
  return crs;
}

}  // namespace

std::optional<MapDifference> difference_of_maps(const fs::path& old_map, const fs::path& new_map) {
  const Database before = Database::open_untrusted(old_map, kMaxMapBlobBytes);
  const Database after = Database::open_untrusted(new_map, kMaxMapBlobBytes);
  if (crs_of(before) != crs_of(after)) return std::nullopt;
  const StoredTiles old_tiles = stored_tiles(before);
  const StoredTiles new_tiles = stored_tiles(after);
  MapDifference difference;
  for (const auto& [tile, stored] : new_tiles) {
    const auto found = old_tiles.find(tile);
    if (found == old_tiles.end()) {
      ++difference.added;
    } else {
      ++(found->second == stored ? difference.same : difference.changed);
    }
  }
  difference.removed = static_cast<std::int64_t>(old_tiles.size()) - difference.same - difference.changed;
  return difference;
}

void check_map_to_update(const fs::path& old_map, const MapPurpose& purpose) {
  const auto version = MapReader::open_unverified(old_map).purpose().map_version;
  stored_tiles(Database::open_untrusted(old_map, kMaxMapBlobBytes));
  if (!version || (purpose.map_version && *purpose.map_version > *version)) return;
  throw UsageError("--update: " + old_map.string() + " is map version " + std::to_string(*version) +
                   "; give a larger --map-version" +
                   (purpose.map_version ? " than " + std::to_string(*purpose.map_version) : ""));
}

void write_map_delta(const fs::path& path, const fs::path& old_map, const fs::path& new_map,
                     const std::optional<fs::path>& signature, const std::optional<fs::path>& chunk_list,
                     const Progress& progress) {
  MapBytes before(old_map);
  MapBytes after(new_map);
  std::vector<std::uint8_t> header;
  append_text(header, kMapDeltaMagic);
  append_le(header, before.size());
  append_digest(header, file_digest(old_map));
  append_le(header, after.size());
  append_digest(header, file_digest(new_map));
  const std::string signature_text = signature ? read_file(*signature, kMaxDeltaSignatureBytes) : "";
  append_le(header, static_cast<std::uint32_t>(signature_text.size()));
  append_text(header, signature_text);
  const std::string list = chunk_list ? read_file(*chunk_list) : "";
  append_le(header, static_cast<std::uint64_t>(list.size()));
  append_text(header, list);

  std::ofstream file(path, std::ios::binary);
  const auto write = [&](const auto& bytes) {
    file.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  };
  write(header);
  const OldPages pages(before);
  Compressor compressor;
  const std::uint64_t window_bytes = std::min<std::uint64_t>(kDeltaWindowBytes, before.size());
  for (std::uint64_t offset = 0; offset < after.size(); offset += kDeltaFrameBytes) {
    report_progress(progress, "writing the delta", static_cast<std::int64_t>(offset),
                    static_cast<std::int64_t>(after.size()));
    const std::string part = after.read(offset, kDeltaFrameBytes);
    const std::uint64_t last_window = before.size() - window_bytes;
    const std::uint64_t begin =
        std::min(last_window, pages.best_window(part, window_bytes, std::min(offset, last_window)));
    const std::string window = before.read(begin, window_bytes);
    const std::string compressed = compressor.compress(part, window);
    std::vector<std::uint8_t> frame;
    append_le(frame, begin);
    append_le(frame, static_cast<std::uint32_t>(window.size()));
    append_le(frame, static_cast<std::uint32_t>(part.size()));
    append_le(frame, static_cast<std::uint32_t>(compressed.size()));
    write(frame);
    write(compressed);
  }
  file.close();
  if (!file) throw DataError(path.string() + ": cannot be written");
}

}  // namespace pilotage
