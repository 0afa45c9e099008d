#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "pilotage/raster/color_source.h"
#include "pilotage/raster/gdal_imagery.h"
#include "pilotage/raster/gray_source.h"
#include "pilotage/raster/raster.h"

// Imagery → gray windows. In all of these:
//
// Gray of one band = its values. Gray of red, green, blue = BT.601 luma exactly as cv::cvtColor(COLOR_RGB2GRAY) rounds
// it for 8- and 16-bit values, 0.299 R + 0.587 G + 0.114 B in double precision for all other types. A palette is
// expanded to colours first; complex values become their magnitude. Depth: Byte → CV_8U, UInt16 → CV_16U, all others →
// CV_64F.
//
// Valid = GDAL's mask is not 0 (alpha, mask band, no-data value), the pixel is not of a collar (ImageryInfo::collar),
// and the gray value is finite. With a no-data value and
// three bands, an 8-bit pixel is invalid when all three bands hold it (0 and 255 are ordinary values of one channel), a
// pixel of another type when any of them does. On a grid, a pixel is valid when the imagery's pixel at its centre is
// (at its centre or, when averaging, anywhere under it); what is not valid never mixes into its neighbours.
//
// Reading streams: each thread that reads at the same time has its own GDAL handle, and GDAL's block cache is held
// to 256 MiB unless GDAL_CACHEMAX says otherwise. Values do not depend on the windows or the threads that read them.

namespace pilotage {

/// The raster on its own pixel grid, nothing resampled; rotated geotransforms too. Throws as inspect_imagery; `read`
/// throws DataError when data cannot be read.
GraySource open_gray(const std::string& dataset, const ImageryOptions& options = {});

/// A picture that needs no place on the ground, such as a frame of a camera: by the same rules, as it is stored (an
/// orientation that EXIF states is not applied, because a calibration refers to the stored pixels), in 8 bits
/// (stretch_to_8bit), 0 where it is not valid. `accept` is told its size, pixels, before anything of them is read or
/// memory taken for them, and may throw. Throws as inspect_picture, and DataError when it has more than 2^29 pixels or
/// its data cannot be read.
cv::Mat read_gray8_picture(const std::string& dataset, const std::function<void(int width, int height)>& accept = {});

/// The same picture in colour: three channels (red, green, blue), CV_8U; a picture of one band shows three equal ones.
/// Throws as read_gray8_picture, and DataError when its values are not of 8 bits.
cv::Mat read_rgb8_picture(const std::string& dataset, const std::function<void(int width, int height)>& accept = {});

/// One or several rasters of any CRS on a mission grid of width_px × height_px pixels, later ones on top where valid.
/// `map_from_pixel` must be north-up (no rotation, y downwards), in `crs`. Overviews are used when the grid is coarser
/// than the imagery. 8-bit imagery stays CV_8U; parts of different depths become CV_64F. Transform error at most 0.05
/// px of the grid. Throws UsageError for a grid that is not as said, DataError as inspect_imagery.
GraySource open_gray_on_grid(const std::vector<std::string>& datasets, const Crs& crs,
                             const GeoTransform& map_from_pixel, std::int64_t width_px, std::int64_t height_px,
                             const ImageryOptions& options = {});

/// The same in colour: red, green and blue (the bands that gray is made of; a palette is expanded) as they are stored,
/// or the one band there is. Where parts of a mosaic have colours, those of one band show three equal ones. Throws as
/// open_gray.
ColorSource open_colors(const std::string& dataset, const ImageryOptions& options = {});

/// Colours on a mission grid. Throws as open_gray_on_grid.
ColorSource open_colors_on_grid(const std::vector<std::string>& datasets, const Crs& crs,
                                const GeoTransform& map_from_pixel, std::int64_t width_px, std::int64_t height_px,
                                const ImageryOptions& options = {});

/// What open_gray_on_grid and open_colors_on_grid give, of one mosaic whose blocks are decoded and warped once for all
/// that read it in either way; the last `kept_bytes` of them stay in memory. Parts that differ in depth or in their
/// number of bands are read by each for itself. Throws as open_gray_on_grid.
GrayAndColors open_gray_and_colors_on_grid(const std::vector<std::string>& datasets, const Crs& crs,
                                           const GeoTransform& map_from_pixel, std::int64_t width_px,
                                           std::int64_t height_px, const ImageryOptions& options,
                                           std::int64_t kept_bytes);

/// Where open_gray_on_grid has ground, pixel for pixel: `pixels` and `valid` are both the mask, 255 or 0. Cheaper than
/// the grays, because a mask needs no interpolation. Throws as open_gray_on_grid.
GraySource open_valid_on_grid(const std::vector<std::string>& datasets, const Crs& crs,
                              const GeoTransform& map_from_pixel, std::int64_t width_px, std::int64_t height_px,
                              const ImageryOptions& options = {});

/// A colour picture of the same mosaic for people to look at: three channels (red, green, blue), CV_8U; one band gives
/// three equal channels. What is not 8 bits deep is stretched linearly between the 2nd and 98th percentile of each
/// channel over the valid pixels of this very picture.
Raster read_rgb8_on_grid(const std::vector<std::string>& datasets, const Crs& crs, const GeoTransform& map_from_pixel,
                         int width_px, int height_px, const ImageryOptions& options = {});

}  // namespace pilotage
