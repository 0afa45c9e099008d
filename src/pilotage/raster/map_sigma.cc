#include "pilotage/raster/map_sigma.h"

#include <algorithm>
#include <cmath>

#include <opencv2/core.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/text.h"
#include "pilotage/raster/gdal_gray.h"

namespace pilotage {

std::filesystem::path map_sigma_path(const std::filesystem::path& imagery) {
  const std::string extension = imagery.extension().string();
  std::filesystem::path path = imagery;
  if (extension == ".tif" || extension == ".tiff" || extension == ".TIF" || extension == ".TIFF")
    path.replace_extension();
  path += ".map_sigma.tif";
  return path;
}

bool map_sigma_exists(const std::string& raster) {
  return raster.starts_with("/vsi") || std::filesystem::exists(raster);
}

GraySource open_map_sigma(const std::vector<std::string>& rasters, const Crs& crs, const GeoTransform& map_from_pixel,
                          std::int64_t width_px, std::int64_t height_px) {
  ImageryOptions options;
  options.bands = {1};
  options.resampling = Resampling::kBilinear;  // cubic overshoots where one map ends on another
  return open_gray_on_grid(rasters, crs, map_from_pixel, width_px, height_px, options);
}

std::optional<double> mean_map_sigma_m(const Raster& sigmas_m, const std::string& names) {
  cv::Mat values;
  sigmas_m.pixels.convertTo(values, CV_64F);
  double sum = 0;
  double count = 0;
  for (int row = 0; row < values.rows; ++row) {
    for (int col = 0; col < values.cols; ++col) {
      if (sigmas_m.valid.at<std::uint8_t>(row, col) == 0) continue;
      const double sigma_m = values.at<double>(row, col);
      if (!(sigma_m >= 0)) {
        throw DataError(names + ": " + format_number(sigma_m) + " m is no standard deviation");
      }
      sum += sigma_m * sigma_m;
      count += 1;
    }
  }
  if (count == 0) return std::nullopt;
  return std::min(std::sqrt(sum / count), kLargestSaidSigma_m);
}

}  // namespace pilotage
