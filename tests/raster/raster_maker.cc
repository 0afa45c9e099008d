#include "raster/raster_maker.h"

#include <stdexcept>

#include <ogr_spatialref.h>

namespace pilotage::testing {

std::string make_raster(const std::filesystem::path& path, const RasterSpec& spec) {
  if (GetGDALDriverManager()->GetDriverByName("GTiff") == nullptr) GDALAllRegister();
  CPLStringList options;
  for (const std::string& option : spec.creation_options) options.AddString(option.c_str());
  GDALDriver* driver = GetGDALDriverManager()->GetDriverByName("GTiff");
  GDALDataset* dataset = driver->Create(path.c_str(), spec.width, spec.height, spec.bands, spec.type, options.List());
  if (dataset == nullptr) throw std::runtime_error("cannot make " + path.string());
  if (spec.georeferenced) {
    std::array<double, 6> numbers{spec.place.origin_x, spec.place.x_per_col, spec.place.x_per_row,
                                  spec.place.origin_y, spec.place.y_per_col, spec.place.y_per_row};
    dataset->SetGeoTransform(numbers.data());
  }
  if (!spec.srs.empty()) {
    OGRSpatialReference reference;
    reference.SetFromUserInput(spec.srs.c_str());
    reference.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
    dataset->SetSpatialRef(&reference);
  }
  spec.finish(*dataset);
  std::vector<double> row_values(static_cast<std::size_t>(spec.width));
  for (int band = 0; band < spec.bands; ++band) {
    for (int row = 0; row < spec.height; ++row) {
      for (int col = 0; col < spec.width; ++col) row_values[static_cast<std::size_t>(col)] = spec.value(band, col, row);
      const CPLErr result = dataset->GetRasterBand(band + 1)->RasterIO(
          GF_Write, 0, row, spec.width, 1, row_values.data(), spec.width, 1, GDT_Float64, 0, 0, nullptr);
      if (result != CE_None) throw std::runtime_error("cannot fill " + path.string());
    }
  }
  GDALClose(GDALDataset::ToHandle(dataset));
  return path.string();
}

void change_raster(const std::filesystem::path& path, const std::function<void(GDALDataset&)>& change) {
  GDALDataset* dataset = GDALDataset::Open(path.c_str(), GDAL_OF_RASTER | GDAL_OF_UPDATE);
  if (dataset == nullptr) throw std::runtime_error("cannot open " + path.string());
  change(*dataset);
  GDALClose(GDALDataset::ToHandle(dataset));
}

}  // namespace pilotage::testing
