#include "pilotage/raster/gdal_files.h"

#include <algorithm>
#include <filesystem>
#include <set>
#include <system_error>

#include <cpl_string.h>
#include <gdal_priv.h>

#include "pilotage/base/error.h"
#include "pilotage/base/file_digest.h"
#include "pilotage/raster/gdal_handle.h"
#include "pilotage/raster/gdal_local_config.h"

namespace pilotage {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxFiles = 1'000'000;  // of a VRT; one that names more is no mosaic

bool is_local_file(const std::string& name) {
  std::error_code ignored;
  return fs::is_regular_file(name, ignored);
}

/// Lies beside a raster and leads nowhere else.
bool is_text_sidecar(const std::string& name) {
  const auto endings = {".aux.xml", ".tfw", ".jgw", ".pgw", ".wld", ".prj", ".tab", ".imd", ".rpb", ".txt"};
  return std::any_of(endings.begin(), endings.end(), [&](const char* ending) { return name.ends_with(ending); });
}

/// What GDAL says belongs to an open dataset. Overviews and masks beside a file are listed once they were asked for.
std::vector<std::string> listed_files(GDALDataset& dataset) {
  if (dataset.GetRasterCount() > 0) {
    static_cast<void>(dataset.GetRasterBand(1)->GetOverviewCount());
    static_cast<void>(dataset.GetRasterBand(1)->GetMaskFlags());
  }
  const CPLStringList list(dataset.GetFileList());
  std::vector<std::string> names;
  for (int i = 0; i < list.size(); ++i) names.emplace_back(list[i]);
  return names;
}

}  // namespace

std::vector<std::string> dataset_files(const std::string& dataset) {
  std::set<std::string> found;
  std::vector<std::string> to_list;
  const auto add = [&](const DatasetPtr& opened) {
    const GdalErrors errors;
    for (const std::string& name : listed_files(*opened)) {
      if (is_local_file(name) && found.insert(name).second) to_list.push_back(name);
    }
  };
  add(open_raster(dataset));
  // A source of a VRT has files of its own, as have masks and overviews. They are asked for by name: to list the folder
  // for each of many tiles takes the square of their number.
  const LocalConfig by_name("GDAL_DISABLE_READDIR_ON_OPEN", "TRUE");
  while (!to_list.empty() && found.size() <= kMaxFiles) {
    const std::string name = to_list.back();
    to_list.pop_back();
    if (name == dataset || is_text_sidecar(name)) continue;
    const GdalErrors errors;
    const DatasetPtr opened(GDALDataset::Open(name.c_str(), GDAL_OF_RASTER | GDAL_OF_READONLY));
    if (opened != nullptr) add(opened);
  }
  if (found.size() > kMaxFiles) {
    throw DataError(dataset + ": names more than " + std::to_string(kMaxFiles) + " files");
  }
  std::vector<std::string> files;
  if (found.erase(dataset) > 0) files.push_back(dataset);
  files.insert(files.end(), found.begin(), found.end());
  return files;
}

std::string dataset_digest(const std::string& dataset) {
  const std::vector<std::string> files = dataset_files(dataset);
  if (files.empty()) return "";
  if (files.size() == 1) return "blake2b-256:" + file_digest(files.front());
  const fs::path folder = fs::absolute(files.front()).lexically_normal().parent_path();
  std::string lines;
  for (const std::string& file : files) {
    lines +=
        file_digest(file) + "  " + fs::absolute(file).lexically_normal().lexically_relative(folder).string() + "\n";
  }
  return "blake2b-256-of-list:" + bytes_digest(lines);
}

}  // namespace pilotage
