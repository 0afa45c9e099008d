#include "pilotage/raster/gdal_guard.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <mutex>
#include <set>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include <cpl_conv.h>
#include <cpl_error.h>
#include <cpl_http.h>
#include <cpl_string.h>
#include <cpl_vsi_virtual.h>
#include <gdal_priv.h>
#include <ogr_srs_api.h>

#include "pilotage/base/error.h"
#include "pilotage/base/text.h"
#include "pilotage/raster/gdal_access.h"
#include "pilotage/raster/gdal_handle.h"
#include "pilotage/raster/gdal_sqlite.h"

namespace pilotage {
namespace {

namespace fs = std::filesystem;

constexpr const char* kMemory = "MEM";

const std::vector<std::string>& web_drivers() {
  static const std::vector<std::string> names{"WMS", "WMTS", "WCS", "HTTP"};
  return names;
}

/// File systems of GDAL that read nothing but this machine's files and memory.
bool is_local(std::string_view prefix) {
  static const std::set<std::string_view> local{"/vsimem/", "/vsizip/", "/vsigzip/", "/vsitar/", "/vsisubfile/"};
  return local.contains(prefix);
}

bool contains(const std::vector<std::string>& names, std::string_view name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

/// A file system whose files cannot be opened.
class ClosedFileSystem : public VSIFilesystemHandler {
 public:
  VSIVirtualHandle* Open(const char* name, const char* /*access*/, bool /*set_error*/,
                         CSLConstList /*options*/) override {
    CPLError(CE_Failure, CPLE_OpenFailed, "%s leads off this machine's files; --allow-network would allow it", name);
    return nullptr;
  }
  int Stat(const char* /*name*/, VSIStatBufL* /*status*/, int /*flags*/) override { return -1; }
};

CPLHTTPResult* refuse_to_fetch(const char* url, CSLConstList /*options*/, GDALProgressFunc /*progress*/,
                               void* /*progress_argument*/, CPLHTTPFetchWriteFunc /*write*/, void* /*write_argument*/,
                               void* /*user*/) {
  const std::string message =
      "the network is switched off; --allow-network would allow " + std::string(url != nullptr ? url : "it");
  CPLError(CE_Failure, CPLE_HttpResponse, "%s", message.c_str());
  auto* result = static_cast<CPLHTTPResult*>(CPLCalloc(1, sizeof(CPLHTTPResult)));
  result->nStatus = 1;
  result->pszErrBuf = CPLStrdup(message.c_str());
  return result;
}

/// What is taken away from GDAL, to be given back.
struct Guard {
  RasterAccess access;
  std::vector<GDALDriver*> taken_drivers;
  std::map<std::string, VSIFilesystemHandler*> fetching;  // GDAL's own, by prefix: "/vsicurl/"
  VSIFilesystemHandler* closed = nullptr;
  bool proj_may_fetch = false;  // as PROJ's own settings say
  std::mutex mutex;
  std::set<std::string> checked;  // versions of files that passed check_access
};

Guard& guard() {
  static auto& one = *new Guard;  // never destroyed: GDAL outlives statics
  return one;
}

bool is_allowed(const GDALDriver& driver, const RasterAccess& access) {
  const std::string name = driver.GetDescription();
  return name == kMemory || contains(raster_drivers(), name) || contains(access.drivers, name) ||
         (access.network && contains(web_drivers(), name));
}

void apply_to_drivers(Guard& guard) {
  GDALDriverManager& manager = *GetGDALDriverManager();
  for (GDALDriver* driver : guard.taken_drivers) manager.RegisterDriver(driver);
  guard.taken_drivers.clear();
  for (int i = 0; i < manager.GetDriverCount(); ++i) {
    GDALDriver* driver = manager.GetDriver(i);
    const bool raster = driver->GetMetadataItem(GDAL_DCAP_RASTER) != nullptr;
    if (raster && !is_allowed(*driver, guard.access)) guard.taken_drivers.push_back(driver);
  }
  for (GDALDriver* driver : guard.taken_drivers) manager.DeregisterDriver(driver);
  // "MEM:::DATAPOINTER=…" is any address of the process; the driver is for what is made, not for what is opened.
  if (GDALDriver* memory = manager.GetDriverByName(kMemory)) {
    memory->pfnOpen = nullptr;
    memory->pfnIdentify = nullptr;
  }
}

void apply_to_file_systems(Guard& guard) {
  if (guard.closed == nullptr) guard.closed = new ClosedFileSystem;
  const CPLStringList prefixes(VSIFileManager::GetPrefixes());
  for (int i = 0; i < prefixes.size(); ++i) {
    const std::string prefix = prefixes[i];
    if (is_local(prefix)) continue;
    VSIFilesystemHandler* const own =
        guard.fetching.try_emplace(prefix, VSIFileManager::GetHandler(prefix.c_str())).first->second;
    VSIFileManager::InstallHandler(prefix, guard.access.network ? own : guard.closed);
  }
}

void apply(Guard& guard) {
  apply_to_drivers(guard);
  apply_to_file_systems(guard);
  CPLHTTPSetFetchCallback(guard.access.network ? nullptr : refuse_to_fetch, nullptr);
  OSRSetPROJEnableNetwork(guard.access.network && guard.proj_may_fetch ? TRUE : FALSE);
  // What a web map's driver keeps of it would stay in the working folder.
  if (CPLGetConfigOption("GDAL_DEFAULT_WMS_CACHE_PATH", nullptr) == nullptr) {
    CPLSetConfigOption("GDAL_DEFAULT_WMS_CACHE_PATH", "/vsimem/pilotage-web-map");
  }
}

/// The file system that fetches, of those that the name leads through, or "".
std::string fetching_part(const std::string& dataset) {
  for (const auto& [prefix, handler] : guard().fetching) {
    const std::string name = prefix.substr(0, prefix.size() - 1);
    for (std::size_t at = dataset.find(name); at != std::string::npos; at = dataset.find(name, at + 1)) {
      const std::size_t end = at + name.size();
      if (end == dataset.size() || std::string_view("/\\?").find(dataset[end]) != std::string_view::npos) return prefix;
    }
  }
  const std::size_t scheme = dataset.find("://");
  return scheme == std::string::npos || dataset.starts_with("vrt://") ? "" : dataset.substr(0, scheme + 3);
}

bool is_special(const fs::path& path) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  return !error && fs::exists(status) && !fs::is_regular_file(status) && !fs::is_directory(status);
}

[[noreturn]] void refuse_pipe(const fs::path& path) {
  throw DataError(path.string() + ": is a pipe or a device, not a file; save what it gives as a file first");
}

/// A dataset string may hold the file behind a driver's name or a file system: "GTIFF_DIR:1:a.tif", "/vsizip/a.zip/b".
void refuse_special_input(const std::string& dataset) {
  std::vector<std::string> candidates{dataset};
  for (std::size_t i = 0; i < dataset.size(); ++i) {
    const bool file_system = dataset[i] == '/' && dataset.starts_with("/vsi");
    if (dataset[i] == ':' || dataset[i] == ',' || file_system) candidates.push_back(dataset.substr(i + 1));
  }
  for (const std::string& candidate : candidates) {
    for (fs::path path = candidate; path.has_filename(); path = path.parent_path()) {
      if (is_special(path)) refuse_pipe(path);
    }
  }
  std::error_code error;
  if (fs::is_regular_file(dataset, error)) {
    const fs::path folder = fs::path(dataset).parent_path();
    refuse_special_beside(dataset, special_files_in(folder.empty() ? "." : folder.string()));
  }
}

/// What a file is now: the check of a large VRT is not done again for each thread that opens it.
std::string version_of(const std::string& dataset) {
  std::error_code error;
  const std::uintmax_t bytes = fs::file_size(dataset, error);
  if (error) return "";
  return dataset + "\n" + std::to_string(bytes) + "\n" +
         std::to_string(fs::last_write_time(dataset, error).time_since_epoch().count());
}

}  // namespace

const std::vector<std::string>& raster_drivers() {
  static const std::vector<std::string> names{"GTiff",   "COG",     "VRT", "JPEG",    "PNG",  "JP2OpenJPEG", "WEBP",
                                              "BMP",     "PNM",     "HFA", "ENVI",    "EHdr", "NITF",        "GPKG",
                                              "MBTiles", "AAIGrid", "AIG", "SRTMHGT", "DTED", "USGSDEM",     "XYZ"};
  return names;
}

void guard_gdal() {
  guard().proj_may_fetch = OSRGetPROJEnableNetwork() != 0;
  apply(guard());
}

void set_raster_access(const RasterAccess& access) {
  const GdalErrors errors;  // registers the drivers
  for (const std::string& name : access.drivers) {
    const bool taken = std::any_of(guard().taken_drivers.begin(), guard().taken_drivers.end(),
                                   [&](const GDALDriver* driver) { return name == driver->GetDescription(); });
    if (taken || GetGDALDriverManager()->GetDriverByName(name.c_str()) != nullptr) continue;
    throw UsageError("gdal_driver = \"" + name + "\" is no driver of this GDAL; `gdalinfo --formats` lists them");
  }
  guard().access = access;
  guard().checked.clear();
  apply(guard());
}

void check_access(const std::string& dataset) {
  const std::string version = version_of(dataset);
  {
    const std::lock_guard lock(guard().mutex);
    if (!version.empty() && guard().checked.contains(version)) return;
  }
  if (!guard().access.network) {
    if (const std::string part = fetching_part(dataset); !part.empty()) {
      throw DataError(dataset + ": leads off this machine's files (" + part +
                      "), which is switched off; fetch it first, or give --allow-network");
    }
  }
  refuse_special_input(dataset);
  check_sqlite_raster(dataset);
  if (!guard().access.any_vrt) check_vrt(dataset);
  const std::lock_guard lock(guard().mutex);
  guard().checked.insert(version);
}

void refuse_other_driver(const std::string& dataset) {
  GDALOpenInfo info(dataset.c_str(), GDAL_OF_RASTER | GDAL_OF_READONLY);
  for (GDALDriver* driver : guard().taken_drivers) {
    if (driver->pfnIdentify == nullptr || driver->pfnIdentify(&info) <= 0) continue;
    const std::string name = driver->GetDescription();
    if (contains(web_drivers(), name)) {
      throw DataError(dataset + ": describes a web map (GDAL's driver " + name +
                      "), and the network is switched off; save the area as GeoTIFF, or give --allow-network");
    }
    throw DataError(dataset + ": is of GDAL's driver " + name + ", which is not opened unasked (" +
                    join(raster_drivers(), ", ") + " are); convert it by gdal_translate, or give --gdal-driver " +
                    name);
  }
}

std::vector<std::string> special_files_in(const std::string& folder) {
  std::vector<std::string> names;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    if (!entry.is_regular_file(error) && !entry.is_directory(error) && entry.exists(error)) {
      names.push_back(entry.path().filename().string());
    }
  }
  return names;
}

void refuse_special_beside(const std::string& file, const std::vector<std::string>& special) {
  const std::string stem = fs::path(file).stem().string();
  for (const std::string& name : special) {
    if (name.starts_with(stem)) refuse_pipe(fs::path(file).replace_filename(name));
  }
}

}  // namespace pilotage
