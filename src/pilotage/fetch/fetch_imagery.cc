#include "pilotage/fetch/fetch_imagery.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <system_error>
#include <tuple>
#include <utility>

#include <fcntl.h>
#include <nlohmann/json.hpp>
#include <sys/file.h>
#include <unistd.h>

#include "pilotage/base/error.h"
#include "pilotage/base/file_digest.h"
#include "pilotage/base/json_object.h"
#include "pilotage/base/options_json.h"
#include "pilotage/base/output_file.h"
#include "pilotage/base/text.h"
#include "pilotage/geo/bounds.h"
#include "pilotage/geo/geodesic.h"
#include "pilotage/geo/geodetic_point.h"
#include "pilotage/mission/licence_json.h"
#include "pilotage/raster/gdal_io.h"
#include "pilotage/raster/gdal_part.h"
#include "pilotage/route/read_route.h"

namespace pilotage {
namespace {

namespace fs = std::filesystem;
using FetchJson = nlohmann::ordered_json;

constexpr int kFetchedVersion = 1;
constexpr const char* kStripFolder = ".fetching-";

/// Around points every kilometre of the route, and `margin_m` beyond them.
DegreeBounds around_route(const Route& route, double margin_m) {
  constexpr double kStep_m = 1000;
  const double first_deg = route.vertices.front().point.lon_deg;
  Bounds around;  // x: longitude, y: latitude
  const auto add = [&](GeodeticPoint point) {
    for (const double azimuth_deg : {0.0, 90.0, 180.0, 270.0}) {
      const GeodeticPoint edge = geodesic_direct(point, azimuth_deg, margin_m);
      around.extend({unwrap_lon_deg(edge.lon_deg, first_deg), edge.lat_deg});
    }
  };
  for (const RouteVertex& vertex : route.vertices) add(vertex.point);
  for (const RouteLeg& leg : route.legs) {
    const GeodeticPoint from = route.vertices[static_cast<std::size_t>(leg.from)].point;
    const GeodesicLeg line = geodesic_between(from, route.vertices[static_cast<std::size_t>(leg.to)].point);
    for (double along_m = kStep_m; along_m < line.length_m; along_m += kStep_m) {
      add(geodesic_direct(from, line.start_azimuth_deg, along_m));
    }
  }
  if (around.width_m() >= 360) return {-180, around.min_y_m, 180, around.max_y_m};
  return {wrap_lon_deg(around.min_x_m), around.min_y_m, wrap_lon_deg(around.max_x_m), around.max_y_m};
}

/// How wide it is, 0 to 360.
double width_deg(const DegreeBounds& bounds) {
  return bounds.east_deg - bounds.west_deg + (bounds.west_deg > bounds.east_deg ? 360 : 0);
}

/// The pixels of a raster that the rectangle touches, and some around them; nothing where it touches none.
std::optional<PixelWindow> window_of(const ImageryInfo& info, const DegreeBounds& bounds) {
  constexpr int kPoints = 32;
  constexpr double kAround_px = 16;
  const CrsTransform transform(info.crs);
  Bounds pixels;
  for (int i = 0; i <= kPoints; ++i) {
    for (int j = 0; j <= kPoints; ++j) {  // inside, too: a pole may lie there
      const GeodeticPoint point{wrap_lon_deg(bounds.west_deg + width_deg(bounds) * i / kPoints),
                                bounds.south_deg + (bounds.north_deg - bounds.south_deg) * j / kPoints};
      auto on_map = transform.map_from_geodetic(point);
      if (!on_map) continue;
      // Of rasters in degrees that count on over the antimeridian.
      if (info.crs.is_geographic()) on_map->x() = unwrap_lon_deg(on_map->x(), info.center.lon_deg);
      pixels.extend(info.map_from_pixel.pixel_from_map(*on_map));
    }
  }
  const auto held = [](double pixel, int size) {
    return static_cast<std::int64_t>(std::clamp(pixel, 0.0, static_cast<double>(size)));
  };
  if (pixels.empty()) return std::nullopt;
  const std::int64_t col = held(std::floor(pixels.min_x_m - kAround_px), info.width_px);
  const std::int64_t row = held(std::floor(pixels.min_y_m - kAround_px), info.height_px);
  const std::int64_t end_col = held(std::ceil(pixels.max_x_m + kAround_px), info.width_px);
  const std::int64_t end_row = held(std::ceil(pixels.max_y_m + kAround_px), info.height_px);
  if (end_col <= col || end_row <= row) return std::nullopt;
  return PixelWindow{col, row, static_cast<int>(end_col - col), static_cast<int>(end_row - row)};
}

/// Where a raster lies, without what an address says of who asks for it: a query (signatures), a name and a password.
std::string public_name(const std::string& dataset) {
  const std::size_t scheme = dataset.find("://");
  if (scheme == std::string::npos) return dataset;
  std::string name = dataset.substr(0, dataset.find_first_of("?#", scheme));
  const std::size_t host = scheme + 3;
  const std::size_t at = name.find('@', host);
  if (at != std::string::npos && at < name.find('/', host)) name.erase(host, at + 1 - host);
  return name;
}

/// A name that any file system takes: letters, digits, "-", "_" and ".", 100 of them at most.
std::string plain_name(const std::string& text) {
  std::string name;
  for (const char c : text.substr(0, 100)) {
    const bool is_plain = (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || c == '-' ||
                          c == '_' || (c == '.' && !name.empty());
    name += is_plain ? c : '_';
  }
  return name;
}

FetchJson file_to_json(const FetchedFile& file) {
  FetchJson json{{"name", file.name},
                 {"item", file.asset.item},
                 {"asset", file.asset.key},
                 {"source", file.source},
                 {"version", file.version},
                 {"window_px", {file.window.col, file.window.row, file.window.width, file.window.height}},
                 {"acquired", file.asset.acquired},
                 {"bytes", file.bytes},
                 {"digest", "blake2b-256:" + file.digest}};
  add_licence(file.asset.licence, json);
  return json;
}

/// `earlier`: entries of an earlier run that this one has not come to yet; they count until then.
std::string list_text(const DegreeBounds& bounds, const std::vector<FetchedFile>& files,
                      std::map<std::string, FetchJson> earlier = {}) {
  FetchJson json{{"pilotage_fetched", kFetchedVersion},
                 {"bounds_deg", {bounds.west_deg, bounds.south_deg, bounds.east_deg, bounds.north_deg}},
                 {"files", FetchJson::array()}};
  for (const FetchedFile& file : files) {
    json["files"].push_back(file_to_json(file));
    earlier.erase(file.name);
  }
  for (const auto& [name, file] : earlier) json["files"].push_back(file);
  return json_text(json);
}

/// The entries of earlier runs by their names; none where there was none.
std::map<std::string, FetchJson> earlier_files(const fs::path& folder) {
  std::map<std::string, FetchJson> files;
  std::error_code error;
  if (!fs::is_regular_file(folder / kFetchedName, error)) return files;
  const std::string name = (folder / kFetchedName).string();
  const FetchJson json = parse_json(name, read_file(name));
  JsonObject object(json, name);
  if (!object.has("pilotage_fetched")) throw DataError(name + ": is no list of fetched imagery; name another folder");
  const std::int64_t version = object.integer("pilotage_fetched", 1);
  if (version > kFetchedVersion) {
    throw DataError(name + ": version " + std::to_string(version) + " is newer than this program reads (" +
                    std::to_string(kFetchedVersion) + ")");
  }
  for (const FetchJson& file : object.list("files")) {
    if (file.is_object() && file.contains("name") && file["name"].is_string()) {
      files[file["name"].get<std::string>()] = file;
    }
  }
  return files;
}

/// Whether the entry of an earlier run is of the same raster and window, with the same words, and its file is there.
bool is_same(const FetchJson& earlier, const FetchedFile& file, const fs::path& path) {
  FetchJson expected = file_to_json(file);
  for (const char* key : {"bytes", "digest"}) expected[key] = earlier.value(key, FetchJson());
  std::error_code error;
  if (expected != earlier || !earlier["bytes"].is_number_integer()) return false;
  return fs::file_size(path, error) == earlier["bytes"].get<std::uintmax_t>() && !error &&
         earlier["digest"] == "blake2b-256:" + file_digest(path);
}

std::vector<std::pair<std::string, std::string>> tags_of(const FetchedFile& file) {
  const StacAsset& asset = file.asset;
  std::vector<std::pair<std::string, std::string>> tags{{"PILOTAGE_SOURCE", file.source}};
  if (!asset.acquired.empty()) tags.emplace_back("ACQUISITION_DATE", asset.acquired);
  if (!asset.licence.terms.empty()) tags.emplace_back(kLicenceTag, asset.licence.terms);
  if (!asset.licence.attribution.empty()) tags.emplace_back(kAttributionTag, asset.licence.attribution);
  return tags;
}

/// While one lives, no other run works in the folder.
class FolderLock {
 public:
  explicit FolderLock(const fs::path& folder)
      : descriptor_(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {
    if (descriptor_ < 0) throw DataError(folder.string() + ": cannot be opened");
    if (::flock(descriptor_, LOCK_EX | LOCK_NB) == 0) return;
    const bool is_taken = errno == EWOULDBLOCK;
    if (!is_taken) return;  // a file system without locks
    ::close(descriptor_);
    throw DataError(folder.string() + ": another run of fetch works in it; wait for its end, or name another folder");
  }
  ~FolderLock() { ::close(descriptor_); }
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  int descriptor_ = -1;
};

/// A file that is to be there, and what is needed to copy it.
struct PlannedFile {
  FetchedFile file;
  RasterPart part;
};

/// Where its rows wait until all are there: another place for another raster, version or window.
fs::path strips_of_file(const fs::path& folder, const FetchedFile& file) {
  const PixelWindow& window = file.window;
  std::string key = file.source + "\n" + file.version;
  for (const std::int64_t number : {window.col, window.row, std::int64_t{window.width}, std::int64_t{window.height}}) {
    key += "\n" + std::to_string(number);
  }
  return folder / (kStripFolder + bytes_digest(key).substr(0, 16));
}

/// `announce` is called with the digest of the file before it appears: what ends the run in between leaves an entry of
/// a file that is not there, never a file that nobody knows.
void fetch_file(const fs::path& folder, bool overwrite, const RasterPart& part, FetchedFile& file,
                const std::function<void()>& announce, const Progress& progress) {
  OutputFile output(folder / file.name, overwrite);
  const fs::path strips = strips_of_file(folder, file);
  std::error_code error;
  fs::create_directories(strips, error);
  if (error) throw DataError(strips.string() + ": cannot be made: " + error.message());
  copy_raster_part(part, output.temporary_path(), strips, progress);
  if (dataset_version(part.dataset) != file.version) {
    fs::remove_all(strips, error);
    throw DataError(part.dataset + ": has changed while it was fetched; fetch it again");
  }
  file.digest = file_digest(output.temporary_path());
  file.bytes = static_cast<std::int64_t>(fs::file_size(output.temporary_path(), error));
  if (error) throw DataError(output.temporary_path().string() + ": cannot be read: " + error.message());
  announce();
  output.commit();
  fs::remove_all(strips, error);
}

/// By date and item, so that names sort as files are to lie on each other: undated ones lowest.
std::string stem_of(const StacAsset& asset) {
  std::string date = asset.acquired.empty() ? "0000_undated" : asset.acquired;
  if (date.size() > 10 && date[10] == 'T') date = date.substr(0, 10) + "T" + date.substr(11, 2) + date.substr(14, 2);
  return date + "_" + plain_name(asset.item);
}

/// The window, date and licence of an asset; nothing when it touches no pixel.
std::optional<PlannedFile> plan_file(const StacAsset& asset, const DegreeBounds& bounds, FetchResult& result,
                                     const Progress& progress) {
  ImageryOptions as_stored;
  as_stored.collar = CollarRule::kKeep;  // to look for one would be to fetch all of it
  const ImageryInfo info = inspect_imagery(asset.dataset, as_stored, progress);
  if (info.control_points) {
    throw DataError(asset.dataset + ": lies by ground control points; warp it first (gdalwarp)");
  }
  const auto window = window_of(info, bounds);
  if (!window) {
    result.outside.push_back(asset.item);
    return std::nullopt;
  }
  result.warnings.insert(result.warnings.end(), info.warnings.begin(), info.warnings.end());
  PlannedFile planned;
  planned.file.asset = asset;
  planned.file.source = public_name(asset.dataset);
  if (asset.licence == Licence{}) planned.file.asset.licence = info.licence;
  if (asset.acquired.empty() && !asset.of_several_days) planned.file.asset.acquired = info.acquired;
  planned.file.version = dataset_version(asset.dataset);
  planned.file.window = *window;
  planned.part = {asset.dataset, *window, info.map_from_pixel, info.crs, tags_of(planned.file)};
  return planned;
}

/// Gives the files their names, in their order, and says which are there; throws where one may not be replaced.
void name_files(const fs::path& folder, bool overwrite, const std::map<std::string, FetchJson>& earlier,
                std::vector<PlannedFile>& planned, const Progress& progress) {
  std::set<std::string> names;
  for (std::size_t i = 0; i < planned.size(); ++i) {
    report_progress(progress, "looking at what is there", static_cast<std::int64_t>(i), std::ssize(planned));
    FetchedFile& file = planned[i].file;
    const std::string stem = stem_of(file.asset);
    for (int number = 1; file.name.empty(); ++number) {
      const std::string name = stem + (number > 1 ? "_" + std::to_string(number) : "") + ".tif";
      if (names.insert(name).second) file.name = name;
    }
    const fs::path path = folder / file.name;
    std::error_code error;
    if (fs::equivalent(path, file.asset.dataset, error)) {
      throw UsageError(path.string() + ": is what would be fetched, and would be lost; name another folder");
    }
    const auto before = earlier.find(file.name);
    if (before != earlier.end() && is_same(before->second, file, path)) {
      file.bytes = before->second["bytes"].get<std::int64_t>();
      file.digest = before->second["digest"].get<std::string>().substr(std::string_view("blake2b-256:").size());
      file.kept = true;
    } else {
      const OutputFile refused(path, overwrite);  // before hours of work
    }
  }
}

}  // namespace

DegreeBounds bounds_of(const FetchOptions& options) {
  check_options(options);
  if (options.route.empty() == options.bounds_deg.empty()) {
    throw UsageError("what to fetch is said by either a route or bounds_deg");
  }
  if (!options.route.empty()) return around_route(read_route(options.route, options.route_options), options.margin_m);
  const std::vector<double>& b = options.bounds_deg;
  if (b.size() == 4 && width_deg({b[0], b[1], b[2], b[3]}) > 180) {
    throw UsageError("bounds_deg is wider than 180 degrees: are west and east changed over?");
  }
  if (b.size() != 4 || std::abs(b[1]) > 90 || std::abs(b[3]) > 90 || b[1] >= b[3] || b[0] == b[2]) {
    throw UsageError("bounds_deg has four numbers: west, south, east, north, as 16.48,55.49,16.53,55.51");
  }
  return {b[0], b[1], b[2], b[3]};
}

FetchResult fetch_imagery(const std::vector<std::string>& places, const FetchOptions& options, const fs::path& folder,
                          bool overwrite, const Progress& progress) {
  FetchResult result;
  result.bounds = bounds_of(options);
  StacAssets found = find_stac_assets(places, result.bounds, options.asset, progress);
  result.warnings = std::move(found.skipped);
  std::vector<PlannedFile> planned;
  for (std::size_t i = 0; i < found.assets.size(); ++i) {
    report_progress(progress, "looking at the imagery", static_cast<std::int64_t>(i), std::ssize(found.assets));
    if (auto file = plan_file(found.assets[i], result.bounds, result, progress)) planned.push_back(*std::move(file));
  }
  if (planned.empty()) {
    const DegreeBounds& b = result.bounds;
    throw DataError("no imagery of the catalogue lies in the rectangle " + format_fixed(b.west_deg, 5) + ", " +
                    format_fixed(b.south_deg, 5) + ", " + format_fixed(b.east_deg, 5) + ", " +
                    format_fixed(b.north_deg, 5) + " (west, south, east, north)" +
                    (result.warnings.empty() ? "" : "; " + result.warnings.front()));
  }
  std::sort(planned.begin(), planned.end(), [](const PlannedFile& a, const PlannedFile& b) {
    return std::tuple(stem_of(a.file.asset), a.file.asset.dataset) <
           std::tuple(stem_of(b.file.asset), b.file.asset.dataset);
  });
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw DataError(folder.string() + ": cannot be made: " + error.message());
  const FolderLock lock(folder);
  std::map<std::string, FetchJson> earlier = earlier_files(folder);
  name_files(folder, overwrite, earlier, planned, progress);
  const auto write_list = [&] {
    write_file(folder / kFetchedName, list_text(result.bounds, result.files, earlier), true);
  };
  for (PlannedFile& next : planned) {
    FetchedFile& file = result.files.emplace_back(std::move(next.file));
    if (!file.kept) fetch_file(folder, overwrite, next.part, file, write_list, progress);
  }
  for (const FetchedFile& file : result.files) earlier.erase(file.name);
  std::erase_if(earlier, [&](const auto& entry) { return !fs::is_regular_file(folder / entry.first, error); });
  for (const auto& [name, entry] : earlier) {
    result.warnings.push_back((folder / name).string() +
                              ": is of an earlier run, and not of this catalogue and rectangle");
  }
  write_list();
  return result;
}

}  // namespace pilotage
