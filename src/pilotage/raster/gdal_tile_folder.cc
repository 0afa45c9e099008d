#include "pilotage/raster/gdal_tile_folder.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <map>
#include <mutex>
#include <numbers>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include <gdal_priv.h>
#include <nlohmann/json.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/markup.h"
#include "pilotage/base/read_file.h"
#include "pilotage/base/text.h"
#include "pilotage/raster/gdal_local_config.h"

namespace pilotage {
namespace {

namespace fs = std::filesystem;

constexpr int kDeepestLevel = 24;  // 1 cm: pixels of deeper levels do not count in an int
constexpr std::size_t kMaxTiles = 200'000;
constexpr std::uintmax_t kMaxDescriptionBytes = 1 << 20;
constexpr double kWorldHalf_m = std::numbers::pi * 6378137;  // of EPSG:3857

struct WebTile {
  std::int64_t x = 0;
  std::int64_t y = 0;  // as the file is named
  fs::path file;
};

/// The number that all of a name spells, as tiles are named: digits alone.
std::optional<std::int64_t> number_of(const std::string& name) {
  std::int64_t number = 0;
  const auto [end, error] = std::from_chars(name.data(), name.data() + name.size(), number);
  const bool digits = !name.empty() && name.front() != '-' && error == std::errc() && end == name.data() + name.size();
  return digits ? std::optional(number) : std::nullopt;
}

/// The number of a tile's file, which may say that its picture is that of a dense screen: "180596@2x".
std::optional<std::int64_t> tile_number(const std::string& stem) {
  const std::size_t at = stem.find('@');
  if (at == std::string::npos) return number_of(stem);
  const bool density = stem.size() == at + 3 && stem[at + 1] >= '1' && stem[at + 1] <= '9' && stem[at + 2] == 'x';
  return density ? number_of(stem.substr(0, at)) : std::nullopt;
}

bool is_picture(const fs::path& file) {
  const auto endings = {".png", ".jpg", ".jpeg", ".webp", ".PNG", ".JPG", ".JPEG"};
  const std::string ending = file.extension().string();
  return std::any_of(endings.begin(), endings.end(), [&](const char* known) { return ending == known; });
}

void refuse_link(const fs::directory_entry& entry) {
  if (!entry.is_symlink()) return;
  throw DataError(entry.path().string() + ": is a symbolic link; the tiles of a folder must lie in it");
}

/// The folders of a folder that are named by numbers, in their order.
std::map<std::int64_t, fs::path> numbered_folders(const fs::path& folder) {
  std::map<std::int64_t, fs::path> found;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    const auto number = number_of(entry.path().filename().string());
    if (!number || !entry.is_directory()) continue;
    refuse_link(entry);
    found.emplace(*number, entry.path());
  }
  if (error) throw DataError(folder.string() + ": cannot be listed: " + error.message());
  return found;
}

std::vector<WebTile> tiles_of_level(const fs::path& level, std::int64_t rows) {
  std::vector<WebTile> tiles;
  for (const auto& [x, column] : numbered_folders(level)) {
    std::error_code error;
    for (const auto& entry : fs::directory_iterator(column, error)) {
      const auto y = tile_number(entry.path().stem().string());
      if (!y || !is_picture(entry.path())) continue;
      refuse_link(entry);
      if (x >= rows || *y >= rows) {
        throw DataError(entry.path().string() + ": columns and rows of this level are 0 to " +
                        std::to_string(rows - 1));
      }
      tiles.push_back({x, *y, entry.path()});
      if (tiles.size() > kMaxTiles) {
        throw DataError(level.string() + ": holds more than " + std::to_string(kMaxTiles) +
                        " tiles; make one raster of the area (MBTiles, GeoTIFF), or give a folder with less of it");
      }
    }
    if (error) throw DataError(column.string() + ": cannot be listed: " + error.message());
  }
  std::sort(tiles.begin(), tiles.end(), [](const WebTile& a, const WebTile& b) {
    return std::pair(a.x, a.y) != std::pair(b.x, b.y) ? std::pair(a.x, a.y) < std::pair(b.x, b.y) : a.file < b.file;
  });
  const auto twice = std::adjacent_find(tiles.begin(), tiles.end(),
                                        [](const WebTile& a, const WebTile& b) { return a.x == b.x && a.y == b.y; });
  if (twice != tiles.end()) {
    throw DataError(twice->file.string() + " and " + std::next(twice)->file.string() + " are the same tile");
  }
  return tiles;
}

/// How tiles are named: z/x/y with rows from the north (XYZ, taken where nothing says it) or from the south (TMS), or
/// z/y/x with rows from the north, as ArcGIS servers do.
enum class Rows { kFromNorth, kFromSouth, kRowsFirst, kUnsaid };

/// Text of a small file beside the levels, or "".
std::string description(const fs::path& file) {
  std::error_code error;
  if (!fs::is_regular_file(file, error)) return "";
  return read_file(file, kMaxDescriptionBytes);
}

Rows rows_of(const fs::path& folder) {
  if (const std::string text = description(folder / "tilemapresource.xml"); !text.empty()) {
    const bool mercator = text.find("EPSG:3857") != std::string::npos ||
                          text.find("EPSG:900913") != std::string::npos || text.find("mercator") != std::string::npos;
    if (!mercator) {
      throw DataError((folder / "tilemapresource.xml").string() +
                      ": the tiles are not of the web's Mercator (EPSG:3857); make them so (gdal2tiles.py --profile "
                      "mercator), or give the raster that they were made of");
    }
    return Rows::kFromSouth;
  }
  const std::string text = description(folder / "metadata.json");
  if (text.empty()) return Rows::kUnsaid;
  const auto json = nlohmann::json::parse(text, nullptr, false);
  if (!json.is_object() || !json.contains("scheme") || !json["scheme"].is_string()) return Rows::kUnsaid;
  const auto scheme = json["scheme"].get<std::string>();
  if (scheme == "xyz") return Rows::kFromNorth;
  if (scheme == "tms") return Rows::kFromSouth;
  if (scheme == "zyx") return Rows::kRowsFirst;
  throw DataError((folder / "metadata.json").string() + ": scheme = \"" + scheme.substr(0, 40) +
                  "\" is none of xyz, tms and zyx");
}

/// What a tile's picture is made of.
struct Picture {
  int size_px = 0;
  int bands = 0;
  bool palette = false;
};

Picture look_at(const WebTile& tile) {
  const GdalErrors errors;
  // By content GDAL would open a VRT with a tile's name, too.
  const char* const drivers[] = {"PNG", "JPEG", "WEBP", nullptr};
  const std::string name = tile.file.string();
  const DatasetPtr opened(GDALDataset::Open(name.c_str(), GDAL_OF_RASTER | GDAL_OF_READONLY, drivers));
  if (opened == nullptr) errors.throw_data_error(name + ": is not a PNG, JPEG or WebP picture");
  const int bands = opened->GetRasterCount();
  const bool fits = opened->GetRasterXSize() == opened->GetRasterYSize() && bands >= 1 && bands <= 4 &&
                    opened->GetRasterBand(1)->GetRasterDataType() == GDT_Byte;
  if (!fits) throw DataError(name + ": is not a square picture of 8 bits with one to four bands");
  return {opened->GetRasterXSize(), bands,
          bands == 1 && opened->GetRasterBand(1)->GetColorInterpretation() == GCI_PaletteIndex};
}

struct WebLevel {
  int zoom = 0;
  std::vector<WebTile> tiles;
  // Columns and rows from the north that hold tiles.
  std::int64_t west = 0;
  std::int64_t east = 0;
  std::int64_t north = 0;
  std::int64_t south = 0;
};

WebLevel level_of(int zoom, const fs::path& folder, Rows rule) {
  const std::int64_t rows = std::int64_t{1} << zoom;
  WebLevel level{zoom, tiles_of_level(folder, rows)};
  level.west = level.north = std::numeric_limits<std::int64_t>::max();
  level.east = level.south = -1;
  for (WebTile& tile : level.tiles) {
    if (rule == Rows::kFromSouth) tile.y = rows - 1 - tile.y;
    if (rule == Rows::kRowsFirst) std::swap(tile.x, tile.y);
    level.west = std::min(level.west, tile.x);
    level.east = std::max(level.east, tile.x);
    level.north = std::min(level.north, tile.y);
    level.south = std::max(level.south, tile.y);
  }
  return level;
}

/// Band `band` (from 1) of the raster, as it comes out of one tile.
std::string source_xml(const WebTile& tile, const Picture& picture, int band, const WebLevel& level) {
  const bool alpha = band == 4;
  const bool has_alpha = picture.bands == 2 || picture.bands == 4;
  int from = 1;
  std::string change;
  if (picture.palette) {
    change = "<ColorTableComponent>" + std::to_string(band) + "</ColorTableComponent>";
  } else if (alpha && !has_alpha) {
    change = "<ScaleOffset>255</ScaleOffset><ScaleRatio>0</ScaleRatio>";  // a tile without alpha is opaque
  } else if (alpha) {
    from = picture.bands;
  } else if (picture.bands >= 3) {
    from = band;
  }
  const std::string size = std::to_string(picture.size_px);
  const std::string kind = change.empty() ? "SimpleSource" : "ComplexSource";
  return "<" + kind + "><SourceFilename relativeToVRT=\"0\">" + html_escape(tile.file.string()) +
         "</SourceFilename><SourceBand>" + std::to_string(from) + "</SourceBand><SourceProperties RasterXSize=\"" +
         size + "\" RasterYSize=\"" + size + "\" DataType=\"Byte\" BlockXSize=\"" + size +
         "\" BlockYSize=\"1\"/><SrcRect xOff=\"0\" yOff=\"0\" xSize=\"" + size + "\" ySize=\"" + size +
         "\"/><DstRect xOff=\"" + std::to_string((tile.x - level.west) * picture.size_px) + "\" yOff=\"" +
         std::to_string((tile.y - level.north) * picture.size_px) + "\" xSize=\"" + size + "\" ySize=\"" + size +
         "\"/>" + change + "</" + kind + ">";
}

std::string vrt_of(const WebLevel& level) {
  const LocalConfig by_name("GDAL_DISABLE_READDIR_ON_OPEN", "EMPTY_DIR");  // not the folder again for each of its tiles
  std::array<std::string, 4> bands;
  int size_px = 0;
  for (const WebTile& tile : level.tiles) {
    const Picture picture = look_at(tile);
    if (size_px == 0) size_px = picture.size_px;
    if (picture.size_px != size_px) {
      throw DataError(tile.file.string() + ": has " + std::to_string(picture.size_px) + " px, " +
                      level.tiles.front().file.string() + " " + std::to_string(size_px));
    }
    for (int band = 1; band <= 4; ++band) {
      bands[static_cast<std::size_t>(band - 1)] += source_xml(tile, picture, band, level);
    }
  }
  const std::int64_t width_px = (level.east - level.west + 1) * size_px;
  const std::int64_t height_px = (level.south - level.north + 1) * size_px;
  if (std::max(width_px, height_px) > std::numeric_limits<int>::max()) {
    throw DataError(level.tiles.front().file.string() +
                    " and the other tiles of its level lie too far apart for one "
                    "raster; give folders with one area each");
  }
  const double side_m = 2 * kWorldHalf_m / std::exp2(level.zoom);
  const double pixel_m = side_m / size_px;
  std::string vrt =
      "<VRTDataset rasterXSize=\"" + std::to_string(width_px) + "\" rasterYSize=\"" + std::to_string(height_px) +
      "\"><SRS>EPSG:3857</SRS><GeoTransform>" + format_number(static_cast<double>(level.west) * side_m - kWorldHalf_m) +
      "," + format_number(pixel_m) + ",0," + format_number(kWorldHalf_m - static_cast<double>(level.north) * side_m) +
      ",0," + format_number(-pixel_m) + "</GeoTransform>";
  constexpr std::array<const char*, 4> kColors{"Red", "Green", "Blue", "Alpha"};
  for (std::size_t band = 0; band < bands.size(); ++band) {
    vrt += "<VRTRasterBand dataType=\"Byte\" band=\"" + std::to_string(band + 1) + "\"><ColorInterp>" + kColors[band] +
           "</ColorInterp>" + bands[band] + "</VRTRasterBand>";
  }
  return vrt + "</VRTDataset>";
}

/// The middle of a level, by longitude and latitude.
std::string middle_of(const WebLevel& level) {
  const double size = std::exp2(level.zoom);
  const double column = static_cast<double>(level.west + level.east + 1) / 2;
  const double row = static_cast<double>(level.north + level.south + 1) / 2;
  const double lat_rad = std::atan(std::sinh(std::numbers::pi * (1 - 2 * row / size)));
  return "lon " + format_fixed(column / size * 360 - 180, 4) + ", lat " +
         format_fixed(lat_rad * 180 / std::numbers::pi, 4);
}

struct TileFolder {
  std::string vrt;
  std::vector<std::string> warnings;
};

TileFolder read_tile_folder(const std::string& name) {
  const fs::path folder(name);
  const Rows rule = rows_of(folder);
  WebLevel deepest;
  WebLevel widest;
  for (const auto& [zoom, path] : numbered_folders(folder)) {
    if (zoom > kDeepestLevel) {
      throw DataError(path.string() + ": zoom levels are 0 to " + std::to_string(kDeepestLevel));
    }
    WebLevel level = level_of(static_cast<int>(zoom), path, rule);
    if (level.tiles.empty()) continue;
    if (level.tiles.size() > widest.tiles.size()) widest = level;
    deepest = std::move(level);
  }
  if (deepest.tiles.empty()) throw DataError(name + ": holds no tiles z/x/y.png, .jpg or .webp (also named y@2x)");
  TileFolder result;
  result.vrt = vrt_of(deepest);
  if (rule == Rows::kUnsaid) {
    const fs::path level = folder / std::to_string(deepest.zoom);
    result.warnings.push_back(
        name +
        ": does not say how its tiles are named; taken for z/x/y with rows from the north, as web maps do, with its "
        "middle at " +
        middle_of(deepest) + ". With rows from the south (TMS) it would be " +
        middle_of(level_of(deepest.zoom, level, Rows::kFromSouth)) + ", as z/y/x (ArcGIS servers) " +
        middle_of(level_of(deepest.zoom, level, Rows::kRowsFirst)) +
        ": write {\"scheme\": \"tms\"} or {\"scheme\": \"zyx\"} into " + (folder / "metadata.json").string());
  }
  // Each level deeper has about four times as many tiles where both cover the same ground.
  if (widest.tiles.size() > deepest.tiles.size()) {
    result.warnings.push_back(name + ": its level " + std::to_string(deepest.zoom) + " is read, which has " +
                              std::to_string(deepest.tiles.size()) + " tiles; level " + std::to_string(widest.zoom) +
                              " has " + std::to_string(widest.tiles.size()) +
                              " and so covers more ground: where level " + std::to_string(deepest.zoom) +
                              " has no tile, there is no imagery");
  }
  return result;
}

const TileFolder& tile_folder(const std::string& name) {
  static std::mutex mutex;
  static auto& known = *new std::map<std::string, TileFolder>;  // never destroyed: threads may outlive statics
  const std::lock_guard lock(mutex);
  const std::string key = fs::absolute(name).lexically_normal().string();
  const auto found = known.find(key);
  return found != known.end() ? found->second : known.emplace(key, read_tile_folder(name)).first->second;
}

}  // namespace

bool is_tile_folder(const std::string& name) {
  std::error_code error;
  if (!fs::is_directory(name, error)) return false;
  for (const auto& entry : fs::directory_iterator(name, error)) {
    if (number_of(entry.path().filename().string()) && entry.is_directory(error)) return true;
  }
  return false;
}

DatasetPtr open_tile_folder(const std::string& folder) {
  const std::string& vrt = tile_folder(folder).vrt;
  const GdalErrors errors;
  const char* const drivers[] = {"VRT", nullptr};
  DatasetPtr opened(GDALDataset::Open(vrt.c_str(), GDAL_OF_RASTER | GDAL_OF_READONLY | GDAL_OF_VERBOSE_ERROR, drivers));
  if (opened == nullptr) errors.throw_data_error(folder + ": its tiles cannot be opened as one raster");
  return opened;
}

std::vector<std::string> tile_folder_warnings(const std::string& folder) {
  return tile_folder(folder).warnings;
}

}  // namespace pilotage
