#include "pilotage/raster/gray_source.h"

namespace pilotage {

GraySource gray_source_from(const Raster& raster) {
  GraySource source;
  source.width_px = raster.pixels.cols;
  source.height_px = raster.pixels.rows;
  source.map_from_pixel = raster.map_from_pixel;
  source.depth = raster.pixels.depth();
  source.read = [raster](const PixelWindow& window) {
    const cv::Rect rect(static_cast<int>(window.col), static_cast<int>(window.row), window.width, window.height);
    return Raster{raster.pixels(rect), raster.valid(rect),
                  raster.map_from_pixel.shifted(static_cast<double>(window.col), static_cast<double>(window.row))};
  };
  return source;
}

}  // namespace pilotage
