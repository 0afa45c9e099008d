#include "pilotage/raster/gdal_memory.h"

#include <array>

#include <gdal_priv.h>

namespace pilotage {

DatasetPtr create_in_memory(const cv::Size& size, int bands, GDALDataType type, const Crs& crs,
                            const GeoTransform& place, const std::string& name) {
  const GdalErrors errors;
  GDALDriver* driver = GetGDALDriverManager()->GetDriverByName("MEM");
  DatasetPtr dataset(driver == nullptr ? nullptr : driver->Create("", size.width, size.height, bands, type, nullptr));
  if (dataset == nullptr) errors.throw_data_error(name + ": no memory for the raster");
  std::array<double, 6> numbers{place.origin_x, place.x_per_col, place.x_per_row,
                                place.origin_y, place.y_per_col, place.y_per_row};
  dataset->SetGeoTransform(numbers.data());
  dataset->SetProjection(crs.wkt().c_str());
  return dataset;
}

}  // namespace pilotage
