#include "pilotage/raster/gdal_write.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <gdal_priv.h>
#include <opencv2/core.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/output_file.h"
#include "pilotage/base/text.h"
#include "pilotage/raster/gdal_cog.h"
#include "pilotage/raster/gdal_handle.h"
#include "pilotage/raster/gdal_local_config.h"
#include "pilotage/raster/gdal_memory.h"

namespace pilotage {
namespace {

void fill(GDALRasterBand& band, const cv::Mat& values, GDALDataType type, const std::string& path) {
  const GdalErrors errors;
  cv::Mat rows = values.isContinuous() ? values : values.clone();
  if (band.RasterIO(GF_Write, 0, 0, rows.cols, rows.rows, rows.data, rows.cols, rows.rows, type, 0, 0, nullptr) !=
      CE_None) {
    errors.throw_data_error(path + ": cannot be written");
  }
}

/// Over the finite values, in two passes from left to right and top to bottom, so that the last digit never changes.
void set_statistics(GDALRasterBand& band, const cv::Mat& values) {
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  double sum = 0;
  double count = 0;
  const auto for_each = [&](const auto& use) {
    for (int row = 0; row < values.rows; ++row) {
      for (int col = 0; col < values.cols; ++col) {
        const double value =
            values.depth() == CV_32F ? static_cast<double>(values.at<float>(row, col)) : values.at<double>(row, col);
        if (std::isfinite(value)) use(value);
      }
    }
  };
  for_each([&](double value) {
    low = std::min(low, value);
    high = std::max(high, value);
    sum += value;
    count += 1;
  });
  const std::string percent = format_number(100 * count / static_cast<double>(values.total()));
  band.SetMetadataItem("STATISTICS_VALID_PERCENT", percent.c_str());
  if (count == 0) return;
  const double mean = sum / count;
  double squares = 0;
  for_each([&](double value) { squares += (value - mean) * (value - mean); });
  band.SetMetadataItem("STATISTICS_MINIMUM", format_number(low).c_str());
  band.SetMetadataItem("STATISTICS_MAXIMUM", format_number(high).c_str());
  band.SetMetadataItem("STATISTICS_MEAN", format_number(mean).c_str());
  band.SetMetadataItem("STATISTICS_STDDEV", format_number(std::sqrt(squares / count)).c_str());
}

void write_cog(GDALDataset& source, const std::filesystem::path& path, bool overwrite,
               const std::vector<std::string>& options, const Progress& progress) {
  OutputFile output(path, overwrite);
  make_cog(source, output.temporary_path(), path.string(), options, progress);
  output.commit();
}

void check_size(const std::string& name, const cv::Mat& values, const cv::Size& size, int type) {
  if (values.empty() || values.type() != type) {
    throw UsageError("band \"" + name + "\" is empty or of a type other than " + cv::typeToString(type));
  }
  if (values.size() != size) {
    throw UsageError("band \"" + name + "\" has " + std::to_string(values.cols) + " x " + std::to_string(values.rows) +
                     " pixels, the first " + std::to_string(size.width) + " x " + std::to_string(size.height));
  }
}

}  // namespace

void write_score_raster(const std::filesystem::path& path, const std::vector<ScoreBand>& bands, const Crs& crs,
                        const GeoTransform& map_from_pixel, bool overwrite, const Progress& progress) {
  OutputFile output(path, overwrite);
  write_score_raster(output, bands, crs, map_from_pixel, false, progress);
  output.commit();
}

void write_score_raster(const OutputFile& output, const std::vector<ScoreBand>& bands, const Crs& crs,
                        const GeoTransform& map_from_pixel, bool nearest, const Progress& progress) {
  const std::string name = output.destination().string();
  if (bands.empty()) throw UsageError("a score raster needs a band");
  const cv::Size size = bands.front().values.size();
  const int depth = bands.front().values.type() == CV_32F ? CV_32F : CV_64F;
  const GDALDataType type = depth == CV_32F ? GDT_Float32 : GDT_Float64;
  for (const ScoreBand& band : bands) check_size(band.name, band.values, size, depth);
  const DatasetPtr memory = create_in_memory(size, static_cast<int>(bands.size()), type, crs, map_from_pixel, name);
  for (std::size_t i = 0; i < bands.size(); ++i) {
    GDALRasterBand& band = *memory->GetRasterBand(static_cast<int>(i) + 1);
    fill(band, bands[i].values, type, name);
    band.SetDescription(bands[i].name.c_str());
    if (!bands[i].unit.empty()) band.SetUnitType(bands[i].unit.c_str());
    band.SetNoDataValue(std::numeric_limits<double>::quiet_NaN());
    set_statistics(band, bands[i].values);
  }
  make_cog(*memory, output.temporary_path(), name,
           {"COMPRESS=DEFLATE", "PREDICTOR=YES", "BLOCKSIZE=256",
            std::string("OVERVIEW_RESAMPLING=") + (nearest ? "NEAREST" : "AVERAGE"), "NUM_THREADS=1"},
           progress);
}

void write_class_raster(const std::filesystem::path& path, const std::string& name, const cv::Mat& values,
                        const std::vector<RasterClass>& classes, const Crs& crs, const GeoTransform& map_from_pixel,
                        bool overwrite) {
  check_size(name, values, values.size(), CV_8U);
  if (classes.empty() || classes.size() > kNoClass) {
    throw UsageError(std::to_string(classes.size()) + " classes; a class raster holds 1 to 255");
  }
  const cv::Mat wrong = (values >= static_cast<double>(classes.size())) & (values != kNoClass);
  if (cv::countNonZero(wrong) > 0) throw UsageError("band \"" + name + "\" holds values that are no class");

  const DatasetPtr memory = create_in_memory(values.size(), 1, GDT_Byte, crs, map_from_pixel, path.string());
  GDALRasterBand& band = *memory->GetRasterBand(1);
  fill(band, values, GDT_Byte, path.string());
  band.SetDescription(name.c_str());
  band.SetNoDataValue(kNoClass);
  GDALColorTable colors;
  for (std::size_t i = 0; i < classes.size(); ++i) {
    const GDALColorEntry entry{classes[i].rgb[0], classes[i].rgb[1], classes[i].rgb[2], 255};
    colors.SetColorEntry(static_cast<int>(i), &entry);
    band.SetMetadataItem(("CLASS_" + std::to_string(i)).c_str(), classes[i].name.c_str());
  }
  const GDALColorEntry transparent{0, 0, 0, 0};
  colors.SetColorEntry(kNoClass, &transparent);
  band.SetColorTable(&colors);
  band.SetColorInterpretation(GCI_PaletteIndex);
  write_cog(*memory, path, overwrite,
            {"COMPRESS=DEFLATE", "BLOCKSIZE=256", "OVERVIEW_RESAMPLING=MODE", "NUM_THREADS=1"}, {});
}

void write_picture_cog(const OutputFile& output, const PictureSource& picture, const Progress& progress) {
  constexpr int kBlock_px = 512;
  const std::string name = output.destination().string();
  const std::filesystem::path growing = output.temporary_path().string() + ".blocks.tif";
  const GdalErrors errors;
  GDALDriver* driver = GetGDALDriverManager()->GetDriverByName("GTiff");
  if (driver == nullptr) throw DataError(name + ": this GDAL has no GeoTIFF driver");
  const LocalConfig mask_inside("GDAL_TIFF_INTERNAL_MASK", "YES");
  const std::string block = std::to_string(kBlock_px);
  const std::string block_x = "BLOCKXSIZE=" + block;
  const std::string block_y = "BLOCKYSIZE=" + block;
  const char* const creation[] = {"TILED=YES",        block_x.c_str(),    block_y.c_str(), "INTERLEAVE=PIXEL",
                                  "COMPRESS=DEFLATE", "BIGTIFF=IF_SAFER", "ZLEVEL=1",      nullptr};
  if (picture.width_px > std::numeric_limits<int>::max() || picture.height_px > std::numeric_limits<int>::max()) {
    throw UsageError(name + ": a picture of " + std::to_string(picture.width_px) + " x " +
                     std::to_string(picture.height_px) + " pixels is too large");
  }
  DatasetPtr blocks(driver->Create(growing.c_str(), static_cast<int>(picture.width_px),
                                   static_cast<int>(picture.height_px), 3, GDT_Byte, const_cast<char**>(creation)));
  if (blocks == nullptr) errors.throw_data_error(name + ": cannot be written");
  const GeoTransform& t = picture.map_from_pixel;
  std::array<double, 6> transform{t.origin_x, t.x_per_col, t.x_per_row, t.origin_y, t.y_per_col, t.y_per_row};
  bool written = blocks->SetGeoTransform(transform.data()) == CE_None &&
                 blocks->SetProjection(picture.crs.wkt().c_str()) == CE_None;
  for (const auto& [key, value] : picture.metadata) blocks->SetMetadataItem(key.c_str(), value.c_str());
  written = written && blocks->CreateMaskBand(GMF_PER_DATASET) == CE_None;
  if (!written) errors.throw_data_error(name + ": cannot be written");
  picture.draw([&](std::int64_t col, std::int64_t row, const Raster& part) {
    const GdalErrors of_block;  // of whichever thread draws it
    const cv::Mat pixels = part.pixels.isContinuous() ? part.pixels : part.pixels.clone();
    const cv::Mat valid = part.valid.isContinuous() ? part.valid : part.valid.clone();
    const int x = static_cast<int>(col);
    const int y = static_cast<int>(row);
    const bool done =
        blocks->RasterIO(GF_Write, x, y, pixels.cols, pixels.rows, pixels.data, pixels.cols, pixels.rows, GDT_Byte, 3,
                         nullptr, 3, GSpacing{3} * pixels.cols, 1, nullptr) == CE_None &&
        blocks->GetRasterBand(1)->GetMaskBand()->RasterIO(GF_Write, x, y, valid.cols, valid.rows, valid.data,
                                                          valid.cols, valid.rows, GDT_Byte, 0, 0, nullptr) == CE_None;
    if (!done || of_block.failed()) of_block.throw_data_error(name + ": cannot be written");
  });
  blocks->FlushCache(false);
  if (errors.failed()) errors.throw_data_error(name + ": cannot be written");
  make_cog(*blocks, output.temporary_path(), name,
           {"COMPRESS=DEFLATE", "PREDICTOR=YES", "BLOCKSIZE=" + block, "OVERVIEW_RESAMPLING=AVERAGE",
            "BIGTIFF=IF_SAFER", "NUM_THREADS=1"},
           progress);
  blocks.reset();
  std::error_code ignored;  // it stands in the output's hidden folder, which goes
  std::filesystem::remove(growing, ignored);
}

void write_mbtiles(const std::filesystem::path& path, const cv::Mat& rgba, const Crs& crs,
                   const GeoTransform& map_from_pixel, const std::string& title, const std::string& description,
                   bool overwrite) {
  check_size("picture", rgba, rgba.size(), CV_8UC4);
  const DatasetPtr memory = create_in_memory(rgba.size(), 4, GDT_Byte, crs, map_from_pixel, path.string());
  std::vector<cv::Mat> channels;
  cv::split(rgba, channels);
  for (int band = 1; band <= 4; ++band) {
    fill(*memory->GetRasterBand(band), channels[static_cast<std::size_t>(band - 1)], GDT_Byte, path.string());
    memory->GetRasterBand(band)->SetColorInterpretation(static_cast<GDALColorInterp>(GCI_RedBand + band - 1));
  }
  const GdalErrors errors;
  OutputFile output(path, overwrite);
  GDALDriver* driver = GetGDALDriverManager()->GetDriverByName("MBTiles");
  if (driver == nullptr) throw DataError(path.string() + ": this GDAL has no MBTiles driver");
  const std::string name = "NAME=" + title;
  const std::string text = "DESCRIPTION=" + description;
  const char* const options[] = {"TYPE=overlay", "TILE_FORMAT=PNG", "RESAMPLING=NEAREST",
                                 name.c_str(),   text.c_str(),      nullptr};
  DatasetPtr written(driver->CreateCopy(output.temporary_path().c_str(), memory.get(), TRUE,
                                        const_cast<char**>(options), nullptr, nullptr));
  if (written == nullptr) errors.throw_data_error(path.string() + ": cannot be written");
  std::array<int, 4> coarser{2, 4, 8, 16};
  if (written->BuildOverviews("NEAREST", static_cast<int>(coarser.size()), coarser.data(), 0, nullptr, nullptr,
                              nullptr) != CE_None) {
    errors.throw_data_error(path.string() + ": its coarser levels cannot be written");
  }
  written.reset();
  if (errors.failed()) errors.throw_data_error(path.string() + ": cannot be written");
  output.commit();
}

}  // namespace pilotage
