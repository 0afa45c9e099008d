#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "pilotage/base/progress.h"
#include "pilotage/capture/adjust_block.h"
#include "pilotage/capture/color_balance.h"
#include "pilotage/capture/ground_surface.h"
#include "pilotage/geo/local_frame.h"
#include "pilotage/raster/gdal_write.h"

namespace pilotage {

/// What an orthophoto is made of.
struct OrthoMosaic {
  const AdjustedBlock* block = nullptr;
  const GroundSurface* ground = nullptr;
  const ColorBalance* balance = nullptr;
  LocalFrame frame;  ///< The block's.
  /// A frame's pixels, CV_8UC3, at its full size. Called by several threads.
  std::function<cv::Mat(std::size_t frame)> load;
  std::int64_t width_px = 0;
  std::int64_t height_px = 0;
  Crs crs;
  GeoTransform map_from_pixel;
  double gsd_m = 0;
};

/// East and north, in the block's frame, of a point whose longitude and latitude are given. Heights above the ellipsoid
/// are left out, for points of the ground as for cameras: at 1,000 m that is a scale of 1 + 1.6e-4, and it cancels.
Eigen::Vector2d east_north_m(const LocalFrame& frame, GeodeticPoint point);

/// The inverse, below 1 mm within 100 km.
GeodeticPoint point_at(const LocalFrame& frame, const Eigen::Vector2d& en_m);

/// By how much the meridian of a point turns clockwise from the block's north, seen from above: its own north lies the
/// other way round.
double convergence_deg(const LocalFrame& frame, GeodeticPoint point);

/// Pixels of the map in one cell of what stands beside it, each way.
inline constexpr int kMapCell_px = 16;

/// The values of a layer of such cells where something is drawn; infinite where nothing is known of it.
std::vector<double> known_values(const cv::Mat& cells);

/// What was drawn.
struct MosaicStats {
  std::int64_t valid_px = 0;
  std::vector<std::int64_t> frame_px;  ///< Pixels that each frame has most of.
  /// For each kMapCell_px of the map, the first at its first pixel, CV_32F; NaN where nothing is drawn: standard
  /// deviation of the map's own error, each axis (map_covariance_m2); which frame shows most of it, from 1; how many
  /// frames see its middle (that one always).
  cv::Mat map_sigma_m;
  cv::Mat cell_frame;
  cv::Mat cell_frames_seen;
};

/// Draws an orthophoto in blocks of 512 px: each pixel from the frame that sees it at the least angle off the nadir,
/// fading into the next within a narrow band along the seam and towards the edges of frames; colours balanced;
/// bilinear, so the map must not be coarser than twice the frames. Where no frame sees the ground, or the surface has
/// no height, nothing is drawn. Frames are loaded as they are needed, neighbouring blocks one after the other, and the
/// last ones stay in memory up to 1 GiB. The same bytes for any number of threads.
MosaicStats draw_mosaic(const OrthoMosaic& mosaic, int threads, const Progress& progress,
                        const std::function<void(std::int64_t col, std::int64_t row, const Raster& block)>& write);

/// draw_mosaic() into a Cloud-Optimised GeoTIFF (write_picture_cog; not committed) with GDAL's `metadata`.
MosaicStats write_mosaic(const OutputFile& output, const OrthoMosaic& mosaic,
                         std::vector<std::pair<std::string, std::string>> metadata, int threads,
                         const Progress& progress);

/// The frame, from 0, of which the map shows most around a place in its CRS; nothing where it shows none.
std::optional<std::size_t> shown_frame(const OrthoMosaic& mosaic, const MosaicStats& drawn,
                                       const Eigen::Vector2d& map_m);

}  // namespace pilotage
