#include "pilotage/raster/gdal_handle.h"

#include <filesystem>
#include <mutex>
#include <new>
#include <string>
#include <system_error>

#include <cpl_conv.h>
#include <cpl_error.h>
#include <gdal_priv.h>

#include "pilotage/base/error.h"
#include "pilotage/raster/gdal_guard.h"
#include "pilotage/raster/gdal_tile_folder.h"

namespace pilotage {
namespace {

constexpr GIntBig kBlockCacheBytes = GIntBig{256} << 20;

void CPL_STDCALL collect_error(CPLErr level, CPLErrorNum number, const char* text) {
  if (level == CE_Debug) return CPLDefaultErrorHandler(level, number, text);  // CPL_DEBUG: someone asked for it
  auto* errors = static_cast<GdalErrors*>(CPLGetErrorHandlerUserData());
  if (number == CPLE_OutOfMemory) errors->add_out_of_memory();
  errors->add(level >= CE_Failure, text);
}

void register_gdal() {
  static std::once_flag once;
  std::call_once(once, [] {
    CPLSetErrorHandler(CPLQuietErrorHandler);  // for errors outside any GdalErrors, as in GDAL's own threads
    if (CPLGetConfigOption("GDAL_CACHEMAX", nullptr) == nullptr) GDALSetCacheMax64(kBlockCacheBytes);
    GDALAllRegister();
    guard_gdal();
  });
}

// What to do with the tiles of a web map, which GDAL does not open by their folder or address; "" for anything else.
std::string tiles_remedy(const std::string& dataset) {
  if (dataset.find("{z}") != std::string::npos) {
    return "is the address of a web map's tiles; give the folder that holds them as z/x/y, or describe the address in "
           "an XML file for GDAL's WMS driver "
           "(gdal.org/drivers/raster/wms.html, service TMS) and give that with --allow-network, or save the area as "
           "MBTiles or GeoTIFF";
  }
  std::error_code error;
  if (!std::filesystem::is_directory(dataset, error)) return "";
  return "is a folder, but not of tiles named z/x/y.png, .jpg or .webp; of rasters with a place of their own make one "
         "(gdalbuildvrt all.vrt FOLDER/*.tif)";
}

}  // namespace

GdalErrors::GdalErrors() {
  register_gdal();
  CPLPushErrorHandlerEx(collect_error, this);
}

GdalErrors::~GdalErrors() {
  CPLPopErrorHandler();
}

void GdalErrors::throw_data_error(const std::string& what) const {
  if (out_of_memory_) throw std::bad_alloc();
  throw DataError(message().empty() ? what : what + ": " + message());
}

void GdalErrors::require_whole(const std::string& what) const {
  if (!unread_.empty()) throw DataError(what + ": cannot be read whole: " + unread_);
}

void GdalErrors::add(bool is_failure, const char* text) {
  if (!is_failure) {
    warning_ = text;
    for (const char* words : {"IO error during reading", "Premature end of JPEG file"}) {
      if (unread_.empty() && warning_.find(words) != std::string::npos) unread_ = warning_;
    }
  } else if (failure_.empty()) {
    failure_ = text;
  }
}

void DatasetCloser::operator()(GDALDataset* dataset) const {
  const GdalErrors errors;  // closing may report too
  GDALClose(GDALDataset::ToHandle(dataset));
}

namespace {

/// An overview or mask of a damaged medium is not missing, it is unread.
void require_mask(GDALDataset& opened, const std::string& dataset) {
  const std::string mask = dataset + ".msk";
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(mask, ignored) || opened.GetRasterCount() == 0) return;
  const GdalErrors errors;
  if ((opened.GetRasterBand(1)->GetMaskFlags() & GMF_ALL_VALID) != 0) {
    errors.throw_data_error(mask + ": lies beside the raster as its mask, but cannot be opened");
  }
}

}  // namespace

DatasetPtr open_raster(const std::string& dataset) {
  if (is_tile_folder(dataset)) return open_tile_folder(dataset);
  const GdalErrors errors;
  const std::string remedy = tiles_remedy(dataset);
  if (remedy.empty()) check_access(dataset);
  DatasetPtr opened(GDALDataset::Open(dataset.c_str(), GDAL_OF_RASTER | GDAL_OF_READONLY | GDAL_OF_VERBOSE_ERROR));
  if (opened == nullptr) {
    if (!remedy.empty()) throw DataError(dataset + ": " + remedy);
    refuse_other_driver(dataset);
    errors.throw_data_error(dataset + ": cannot be opened as a raster");
  }
  require_mask(*opened, dataset);
  errors.require_whole(dataset);
  return opened;
}

}  // namespace pilotage
