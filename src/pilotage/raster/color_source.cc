#include "pilotage/raster/color_source.h"

#include <opencv2/imgproc.hpp>

namespace pilotage {

cv::Mat gray_from_colors(const cv::Mat& pixels) {
  if (pixels.channels() == 1) return pixels;
  cv::Mat gray;
  if (pixels.depth() != CV_64F) {
    cv::cvtColor(pixels, gray, cv::COLOR_RGB2GRAY);
    return gray;
  }
  gray.create(pixels.size(), CV_64F);
  for (int row = 0; row < pixels.rows; ++row) {
    const auto* rgb = pixels.ptr<cv::Vec3d>(row);
    auto* value = gray.ptr<double>(row);
    for (int col = 0; col < pixels.cols; ++col) {
      value[col] = 0.299 * rgb[col][0] + 0.587 * rgb[col][1] + 0.114 * rgb[col][2];
    }
  }
  return gray;
}

GraySource gray_source_of(const ColorSource& colors) {
  return {colors.width_px,
          colors.height_px,
          colors.map_from_pixel,
          colors.crs,
          colors.depth,
          [read = colors.read](const PixelWindow& window) {
            Raster raster = read(window);
            raster.pixels = gray_from_colors(raster.pixels);
            return raster;
          },
          colors.block_width_px,
          colors.block_height_px};
}

}  // namespace pilotage
