#include "pilotage/raster/gdal_part.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include <cpl_string.h>
#include <gdal_priv.h>

#include "pilotage/base/error.h"
#include "pilotage/base/output_file.h"
#include "pilotage/raster/gdal_cog.h"
#include "pilotage/raster/gdal_files.h"
#include "pilotage/raster/gdal_handle.h"
#include "pilotage/raster/gdal_local_config.h"
#include "pilotage/raster/map_sigma.h"

namespace pilotage {
namespace {

namespace fs = std::filesystem;

/// How the pixels of a strip lie in its file: band after band, then the mask of the whole raster where it has one.
struct StripShape {
  int width = 0;
  int rows = 0;  ///< Of a strip from border to border of blocks.
  int bands = 0;
  GDALDataType type = GDT_Byte;
  bool has_mask = false;

  std::size_t band_bytes(int strip_rows) const {
    return static_cast<std::size_t>(width) * static_cast<std::size_t>(strip_rows) *
           static_cast<std::size_t>(GDALGetDataTypeSizeBytes(type));
  }
  std::size_t mask_bytes(int strip_rows) const {
    return has_mask ? static_cast<std::size_t>(width) * static_cast<std::size_t>(strip_rows) : 0;
  }
  std::size_t bytes(int strip_rows) const {
    return static_cast<std::size_t>(bands) * band_bytes(strip_rows) + mask_bytes(strip_rows);
  }
};

/// Throws for what one GeoTIFF of all bands does not hold.
void refuse_mixed_bands(GDALDataset& dataset, const std::string& name) {
  GDALRasterBand& first = *dataset.GetRasterBand(1);
  int first_has = FALSE;
  const double first_no_data = first.GetNoDataValue(&first_has);
  for (int number = 1; number <= dataset.GetRasterCount(); ++number) {
    GDALRasterBand& band = *dataset.GetRasterBand(number);
    int has = FALSE;
    const double no_data = band.GetNoDataValue(&has);
    const bool same_no_data = has == first_has && (has == FALSE || no_data == first_no_data ||
                                                   (std::isnan(no_data) && std::isnan(first_no_data)));
    const char* what = band.GetRasterDataType() != first.GetRasterDataType() ? "types"
                       : !same_no_data                                       ? "no-data values"
                       : band.GetMaskFlags() == 0                            ? "masks"
                                                                             : nullptr;
    if (what != nullptr) {
      throw DataError(name + ": its bands have " + what +
                      " of their own; bring it into one form first (gdal_translate)");
    }
  }
}

StripShape shape_of(GDALDataset& dataset, const PixelWindow& window, std::int64_t strip_bytes) {
  StripShape shape;
  shape.width = window.width;
  shape.bands = dataset.GetRasterCount();
  shape.type = dataset.GetRasterBand(1)->GetRasterDataType();
  const int flags = dataset.GetRasterBand(1)->GetMaskFlags();
  shape.has_mask = (flags & GMF_PER_DATASET) != 0 && (flags & GMF_ALPHA) == 0;
  const auto row_bytes = static_cast<std::int64_t>(std::max<std::size_t>(1, shape.bytes(1)));
  int block_width = 0;
  dataset.GetRasterBand(1)->GetBlockSize(&block_width, &shape.rows);
  shape.rows = std::clamp(shape.rows, 1, dataset.GetRasterYSize());
  const std::int64_t blocks = std::max<std::int64_t>(1, strip_bytes / row_bytes / shape.rows);
  shape.rows = static_cast<int>(std::min<std::int64_t>(blocks * shape.rows, dataset.GetRasterYSize()));
  return shape;
}

/// From one border of blocks to the next, so that no block is read twice.
std::vector<PixelWindow> strips_of(const PixelWindow& window, const StripShape& shape) {
  std::vector<PixelWindow> strips;
  const std::int64_t end = window.row + window.height;
  for (std::int64_t row = window.row; row < end;) {
    const std::int64_t next = std::min(end, (row / shape.rows + 1) * shape.rows);
    strips.push_back({window.col, row, window.width, static_cast<int>(next - row)});
    row = next;
  }
  return strips;
}

std::string read_strip(GDALDataset& dataset, const PixelWindow& strip, const StripShape& shape,
                       const std::string& name) {
  const GdalErrors errors;
  std::string bytes(shape.bytes(strip.height), '\0');
  const int col = static_cast<int>(strip.col);
  const int row = static_cast<int>(strip.row);
  bool done = dataset.RasterIO(GF_Read, col, row, strip.width, strip.height, bytes.data(), strip.width, strip.height,
                               shape.type, shape.bands, nullptr, 0, 0,
                               static_cast<GSpacing>(shape.band_bytes(strip.height)), nullptr) == CE_None;
  if (done && shape.has_mask) {
    char* mask = bytes.data() + static_cast<std::size_t>(shape.bands) * shape.band_bytes(strip.height);
    done = dataset.GetRasterBand(1)->GetMaskBand()->RasterIO(GF_Read, col, row, strip.width, strip.height, mask,
                                                             strip.width, strip.height, GDT_Byte, 0, 0,
                                                             nullptr) == CE_None;
  }
  if (!done || errors.read_in_part()) errors.throw_data_error(name + ": cannot be fetched whole");
  return bytes;
}

void write_strip(GDALDataset& file, int row, int rows, std::string& bytes, const StripShape& shape,
                 const std::string& name) {
  const GdalErrors errors;
  bool done =
      file.RasterIO(GF_Write, 0, row, shape.width, rows, bytes.data(), shape.width, rows, shape.type, shape.bands,
                    nullptr, 0, 0, static_cast<GSpacing>(shape.band_bytes(rows)), nullptr) == CE_None;
  if (done && shape.has_mask) {
    char* mask = bytes.data() + static_cast<std::size_t>(shape.bands) * shape.band_bytes(rows);
    done = file.GetRasterBand(1)->GetMaskBand()->RasterIO(GF_Write, 0, row, shape.width, rows, mask, shape.width, rows,
                                                          GDT_Byte, 0, 0, nullptr) == CE_None;
  }
  if (!done || errors.failed()) errors.throw_data_error(name + ": cannot be written");
}

/// What stands beside the pixels of a band.
void copy_band_facts(GDALRasterBand& from, GDALRasterBand& to) {
  to.SetColorInterpretation(from.GetColorInterpretation());
  if (from.GetColorTable() != nullptr) to.SetColorTable(from.GetColorTable());
  int has_value = FALSE;
  const double no_data = from.GetNoDataValue(&has_value);
  if (has_value != FALSE) to.SetNoDataValue(no_data);
  const double scale = from.GetScale(&has_value);
  if (has_value != FALSE && scale != 1) to.SetScale(scale);
  const double offset = from.GetOffset(&has_value);
  if (has_value != FALSE && offset != 0) to.SetOffset(offset);
  to.SetDescription(from.GetDescription());
  to.SetUnitType(from.GetUnitType());
}

DatasetPtr create_like(GDALDataset& from, const RasterPart& part, const StripShape& shape, const fs::path& path,
                       const std::string& name) {
  const GdalErrors errors;
  GDALDriver* driver = GetGDALDriverManager()->GetDriverByName("GTiff");
  if (driver == nullptr) throw DataError(name + ": this GDAL has no GeoTIFF driver");
  const char* const creation[] = {"TILED=YES", "COMPRESS=DEFLATE", "ZLEVEL=1", "BIGTIFF=IF_SAFER", nullptr};
  DatasetPtr to(driver->Create(path.c_str(), part.window.width, part.window.height, shape.bands, shape.type,
                               const_cast<char**>(creation)));
  if (to == nullptr) errors.throw_data_error(name + ": cannot be written");
  const GeoTransform t =
      part.map_from_pixel.shifted(static_cast<double>(part.window.col), static_cast<double>(part.window.row));
  std::array<double, 6> numbers{t.origin_x, t.x_per_col, t.x_per_row, t.origin_y, t.y_per_col, t.y_per_row};
  bool done = to->SetGeoTransform(numbers.data()) == CE_None && to->SetProjection(part.crs.wkt().c_str()) == CE_None;
  for (const char* const* item = from.GetMetadata(); item != nullptr && *item != nullptr; ++item) {
    char* key = nullptr;
    const char* value = CPLParseNameValue(*item, &key);
    // What names files beside the raster, or its pixels' values in other words, is not of the part.
    const bool comes_along = key != nullptr && value != nullptr && std::string_view(key) != "AREA_OR_POINT" &&
                             std::string_view(key) != kMapSigmaTag && std::string_view(key) != "NODATA_VALUES";
    if (comes_along) to->SetMetadataItem(key, value);
    CPLFree(key);
  }
  for (const auto& [key, value] : part.tags) to->SetMetadataItem(key.c_str(), value.c_str());
  for (int band = 1; band <= shape.bands; ++band) copy_band_facts(*from.GetRasterBand(band), *to->GetRasterBand(band));
  done = done && (!shape.has_mask || to->CreateMaskBand(GMF_PER_DATASET) == CE_None);
  if (!done || errors.failed()) errors.throw_data_error(name + ": cannot be written");
  return to;
}

}  // namespace

std::string dataset_version(const std::string& dataset) {
  const DatasetPtr opened = open_raster(dataset);
  std::string version = std::to_string(opened->GetRasterXSize()) + " x " + std::to_string(opened->GetRasterYSize()) +
                        " x " + std::to_string(opened->GetRasterCount()) + " " +
                        GDALGetDataTypeName(opened->GetRasterBand(1)->GetRasterDataType());
  std::vector<std::string> files = dataset_files(dataset);
  if (files.empty()) files.push_back(dataset);
  const GdalErrors errors;  // a name that is no file has no size
  for (const std::string& file : files) {
    VSIStatBufL status{};
    if (VSIStatL(file.c_str(), &status) != 0) continue;
    version += ", " + std::to_string(status.st_size) + " bytes of " + std::to_string(status.st_mtime);
  }
  return version;
}

void copy_raster_part(const RasterPart& part, const fs::path& path, const fs::path& strips, const Progress& progress,
                      std::int64_t strip_bytes) {
  const DatasetPtr from = open_raster(part.dataset);
  const PixelWindow& window = part.window;
  if (window.col < 0 || window.row < 0 || window.width < 1 || window.height < 1 ||
      window.col + window.width > from->GetRasterXSize() || window.row + window.height > from->GetRasterYSize()) {
    throw DataError(part.dataset + ": does not hold the part that is to be copied");
  }
  refuse_mixed_bands(*from, part.dataset);
  const StripShape shape = shape_of(*from, window, strip_bytes);
  const std::vector<PixelWindow> rows = strips_of(window, shape);
  const auto count = std::ssize(rows);
  const auto file_of = [&](const PixelWindow& strip) { return strips / ("rows_" + std::to_string(strip.row)); };
  std::error_code error;
  for (std::int64_t i = 0; i < count; ++i) {
    const PixelWindow& strip = rows[static_cast<std::size_t>(i)];
    report_progress(progress, "fetching " + part.dataset, i, count);
    if (fs::file_size(file_of(strip), error) == shape.bytes(strip.height) && !error) continue;
    write_file(file_of(strip), read_strip(*from, strip, shape, part.dataset), true);
  }
  const LocalConfig mask_inside("GDAL_TIFF_INTERNAL_MASK", "YES");
  const LocalConfig no_side_car("GDAL_PAM_ENABLED", "NO");
  const fs::path growing = path.string() + ".growing.tif";  // goes with the folder in which `path` grows
  DatasetPtr file = create_like(*from, part, shape, growing, path.string());
  for (std::int64_t i = 0; i < count; ++i) {
    const PixelWindow& strip = rows[static_cast<std::size_t>(i)];
    report_progress(progress, "writing " + path.filename().string(), i, count);
    std::string bytes = read_file(file_of(strip));
    write_strip(*file, static_cast<int>(strip.row - window.row), strip.height, bytes, shape, path.string());
  }
  const GdalErrors errors;
  file->FlushCache(false);
  if (errors.failed()) errors.throw_data_error(path.string() + ": cannot be written");
  const bool is_palette = file->GetRasterBand(1)->GetColorTable() != nullptr;
  make_cog(*file, path, path.string(),
           {"COMPRESS=DEFLATE", "PREDICTOR=YES", "BLOCKSIZE=512", "BIGTIFF=IF_SAFER", "NUM_THREADS=1",
            std::string("OVERVIEW_RESAMPLING=") + (is_palette ? "NEAREST" : "AVERAGE")},
           progress);
  file.reset();
  fs::remove(growing, error);
}

}  // namespace pilotage
