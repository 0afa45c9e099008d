#include "pilotage/raster/gdal_geotiff.h"

#include <array>
#include <limits>
#include <memory>

#include <cpl_conv.h>
#include <cpl_error.h>
#include <cpl_string.h>
#include <gdal_priv.h>
#include <ogr_spatialref.h>
#include <opencv2/core.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/output_file.h"
#include "pilotage/raster/gdal_handle.h"

namespace pilotage {
namespace {

/// GDAL's messages go into our errors, not to stderr.
class QuietErrors {
 public:
  QuietErrors() {
    CPLPushErrorHandler(CPLQuietErrorHandler);
    CPLErrorReset();
  }
  ~QuietErrors() { CPLPopErrorHandler(); }
  QuietErrors(const QuietErrors&) = delete;
  QuietErrors& operator=(const QuietErrors&) = delete;
};

[[noreturn]] void fail(const std::filesystem::path& path) {
  const std::string reason = CPLGetLastErrorMsg();
  throw DataError(path.string() + ": cannot be written" + (reason.empty() ? "" : ": " + reason));
}

void check(CPLErr result, const std::filesystem::path& path) {
  if (result != CE_None) fail(path);
}

std::string wkt_of(const std::string& crs) {
  OGRSpatialReference reference;
  if (reference.SetFromUserInput(crs.c_str()) != OGRERR_NONE) throw UsageError("crs \"" + crs + "\" is not known");
  char* text = nullptr;
  const OGRErr result = reference.exportToWkt(&text);
  const std::string wkt = text != nullptr ? text : "";
  CPLFree(text);
  if (result != OGRERR_NONE) throw UsageError("crs \"" + crs + "\" cannot be written as WKT");
  return wkt;
}

void check_raster(const Raster& raster, int type, const char* expected) {
  if (raster.pixels.empty() || raster.pixels.type() != type) {
    throw UsageError("a raster of " + cv::typeToString(raster.pixels.type()) + " cannot be written here: " + expected +
                     " is expected");
  }
  if (raster.valid.size() != raster.pixels.size() || raster.valid.type() != CV_8U) {
    throw UsageError("the mask of a raster must be CV_8U and of its size");
  }
}

DatasetPtr create(const std::filesystem::path& path, const Raster& raster, int bands, GDALDataType type,
                  const std::string& wkt, const GeotiffOptions& options) {
  const GdalErrors errors;  // registers the drivers
  GDALDriver* driver = GetGDALDriverManager()->GetDriverByName("GTiff");
  if (driver == nullptr) throw DataError("GDAL has no GeoTIFF driver");
  CPLStringList creation;
  creation.SetNameValue("TILED", "YES");
  creation.SetNameValue("BLOCKXSIZE", "256");
  creation.SetNameValue("BLOCKYSIZE", "256");
  creation.SetNameValue("BIGTIFF", "IF_SAFER");
  if (options.compression == GeotiffCompression::kJpeg) {
    creation.SetNameValue("COMPRESS", "JPEG");
    creation.SetNameValue("PHOTOMETRIC", "YCBCR");
    creation.SetNameValue("JPEG_QUALITY", std::to_string(options.jpeg_quality).c_str());
  } else {
    creation.SetNameValue("COMPRESS", "DEFLATE");
    creation.SetNameValue("PREDICTOR", type == GDT_Float32 ? "3" : "2");
  }
  if (bands == 3) creation.SetNameValue("INTERLEAVE", "PIXEL");
  DatasetPtr dataset(
      driver->Create(path.c_str(), raster.pixels.cols, raster.pixels.rows, bands, type, creation.List()));
  if (!dataset) fail(path);
  const GeoTransform& t = raster.map_from_pixel;
  std::array<double, 6> transform = {t.origin_x, t.x_per_col, t.x_per_row, t.origin_y, t.y_per_col, t.y_per_row};
  check(dataset->SetGeoTransform(transform.data()), path);
  check(dataset->SetProjection(wkt.c_str()), path);
  for (const auto& [name, value] : options.metadata) check(dataset->SetMetadataItem(name.c_str(), value.c_str()), path);
  return dataset;
}

/// Writes what is still in GDAL's cache; GDAL reports trouble there by its error state alone.
void close(DatasetPtr dataset, const std::filesystem::path& path) {
  CPLErrorReset();
  GDALClose(GDALDataset::ToHandle(dataset.release()));
  if (CPLGetLastErrorType() >= CE_Failure) fail(path);
}

/// The same bytes as `mat`, which GDAL only reads.
void* bytes_of(const cv::Mat& mat, int row) {
  return cv::Mat(mat).ptr(row);
}

}  // namespace

void write_rgb8_geotiff(const std::filesystem::path& path, const Raster& raster, const std::string& crs,
                        const GeotiffOptions& options, bool overwrite) {
  check_raster(raster, CV_8UC3, "CV_8UC3");
  if (options.jpeg_quality < 1 || options.jpeg_quality > 100) {
    throw UsageError("jpeg_quality = " + std::to_string(options.jpeg_quality) + " is outside [1, 100]");
  }
  const QuietErrors quiet;
  const std::string wkt = wkt_of(crs);
  OutputFile output(path, overwrite);
  const int width = raster.pixels.cols;
  const int height = raster.pixels.rows;
  DatasetPtr dataset = create(output.temporary_path(), raster, 3, GDT_Byte, wkt, options);
  const auto stride = static_cast<GSpacing>(raster.pixels.step[0]);
  check(dataset->RasterIO(GF_Write, 0, 0, width, height, bytes_of(raster.pixels, 0), width, height, GDT_Byte, 3,
                          nullptr, 3, stride, 1, nullptr),
        path);
  if (cv::countNonZero(raster.valid) != width * height) {
    CPLSetThreadLocalConfigOption("GDAL_TIFF_INTERNAL_MASK", "YES");
    const CPLErr made = dataset->CreateMaskBand(GMF_PER_DATASET);
    CPLSetThreadLocalConfigOption("GDAL_TIFF_INTERNAL_MASK", nullptr);
    check(made, path);
    GDALRasterBand* mask = dataset->GetRasterBand(1)->GetMaskBand();
    check(mask->RasterIO(GF_Write, 0, 0, width, height, bytes_of(raster.valid, 0), width, height, GDT_Byte, 1,
                         static_cast<GSpacing>(raster.valid.step[0]), nullptr),
          path);
  }
  close(std::move(dataset), path);
  output.commit();
}

void write_float32_geotiff(const std::filesystem::path& path, const Raster& raster, const std::string& crs,
                           const GeotiffOptions& options, bool overwrite) {
  check_raster(raster, CV_32F, "CV_32F");
  if (options.compression != GeotiffCompression::kDeflate) throw UsageError("JPEG cannot hold 32-bit floats");
  const QuietErrors quiet;
  const std::string wkt = wkt_of(crs);
  cv::Mat values = raster.pixels.clone();
  values.setTo(std::numeric_limits<float>::quiet_NaN(), raster.valid == 0);
  OutputFile output(path, overwrite);
  DatasetPtr dataset = create(output.temporary_path(), raster, 1, GDT_Float32, wkt, options);
  GDALRasterBand* band = dataset->GetRasterBand(1);
  check(band->SetNoDataValue(std::numeric_limits<double>::quiet_NaN()), path);
  check(band->RasterIO(GF_Write, 0, 0, values.cols, values.rows, values.ptr(0), values.cols, values.rows, GDT_Float32,
                       4, static_cast<GSpacing>(values.step[0]), nullptr),
        path);
  close(std::move(dataset), path);
  output.commit();
}

}  // namespace pilotage
