#include "pilotage/raster/gdal_png.h"

#include <filesystem>

#include <gdal_priv.h>
#include <opencv2/core.hpp>

#include "pilotage/base/error.h"
#include "pilotage/raster/gdal_handle.h"
#include "pilotage/raster/gdal_memory.h"

namespace pilotage {

void write_gray8_png(const std::filesystem::path& path, const Raster& raster, const Crs& crs) {
  if (raster.pixels.type() != CV_8U) throw UsageError("a PNG is written of one channel of 8 bits");
  const GdalErrors errors;
  const DatasetPtr memory =
      create_in_memory(raster.pixels.size(), 1, GDT_Byte, crs, raster.map_from_pixel, path.string());
  cv::Mat pixels = raster.pixels.isContinuous() ? raster.pixels : raster.pixels.clone();
  if (memory->GetRasterBand(1)->RasterIO(GF_Write, 0, 0, pixels.cols, pixels.rows, pixels.data, pixels.cols,
                                         pixels.rows, GDT_Byte, 0, 0, nullptr) != CE_None) {
    errors.throw_data_error(path.string() + ": cannot be written");
  }
  GDALDriver* driver = GetGDALDriverManager()->GetDriverByName("PNG");
  if (driver == nullptr) throw DataError(path.string() + ": this GDAL has no driver PNG");
  DatasetPtr copy(driver->CreateCopy(path.c_str(), memory.get(), FALSE, nullptr, nullptr, nullptr));
  const bool created = copy != nullptr;
  if (created) GDALClose(GDALDataset::ToHandle(copy.release()));  // what closing has to report counts
  if (!created || errors.failed()) errors.throw_data_error(path.string() + ": cannot be written");
  std::error_code ignored;
  if (!std::filesystem::exists(path.string() + ".aux.xml", ignored)) {
    throw DataError(path.string() + ": its place was not written beside it; is GDAL_PAM_ENABLED switched off?");
  }
}

}  // namespace pilotage
