#include "pilotage/matchability/ground_cover.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <string>

#include <opencv2/imgproc.hpp>

#include "pilotage/base/error.h"
#include "pilotage/geo/tile_groups.h"
#include "pilotage/raster/gray_stretch.h"
#include "pilotage/raster/rectangle_sums.h"

namespace pilotage {
namespace {

constexpr int kColorBox_px = 5;
constexpr int kSmoothBox_px = 9;
constexpr int kMajorityBox_px = 31;
constexpr double kGradientSigma_px = 2;
constexpr int kGradientReach_px = 8;  // of the Gaussian, 3.5 σ, and of the central difference
constexpr int kHalo_px = kSmoothBox_px / 2 + kMajorityBox_px / 2;
static_assert(kHalo_px >= kGradientReach_px);
/// Of a picture in gray stored as colours every pixel is neutral; lossy compression leaves some that are not.
constexpr double kNeutralShare = 0.98;
constexpr double kDarkOffset = 8;  // gray levels: what noise is to the darkest ground

/// 8 bits, all bands in one scale, so that their ratios stay; 0 where there is no ground.
cv::Mat to_8bit(const Raster& raster, double white) {
  cv::Mat pixels;
  raster.pixels.convertTo(pixels, CV_8U, 255 / white);
  if (white == 255) pixels = pixels.clone();
  pixels.setTo(cv::Scalar::all(0), raster.valid == 0);
  return pixels;
}

/// 1 where the pixel is …
struct CoverMasks {
  cv::Mat ground;
  cv::Mat neutral;
  cv::Mat green;
  cv::Mat water;       // by colours
  cv::Mat gray_water;  // without
};

/// Smooth and dark ground, before its surroundings are asked: for one pixel of box sums.
struct Smoothness {
  bool smooth = false;
  double mean = 0;  // of white

  Smoothness(int count, int sum, int squares) {
    const double n = count;
    const double limit = kSmoothContrast * (sum + kDarkOffset * n);
    smooth = n * squares - static_cast<double>(sum) * sum < limit * limit;
    mean = sum / (255 * n);
  }
};

/// Keeps what enough of the surroundings agree with.
void keep_majority(cv::Mat& mask, const cv::Mat& ground_around) {
  const cv::Mat around = box_sum(mask, kMajorityBox_px);
  for (int row = 0; row < mask.rows; ++row) {
    auto* kept = mask.ptr<std::uint8_t>(row);
    const int* alike = around.ptr<int>(row);
    const int* all = ground_around.ptr<int>(row);
    for (int col = 0; col < mask.cols; ++col) {
      if (alike[col] < kWaterMajority * all[col]) kept[col] = 0;
    }
  }
}

/// What colours say, for one pixel of box sums.
struct Hue {
  bool neutral = false;
  bool green = false;
  bool maybe_water = false;

  Hue(int red, int green_sum, int blue) {
    const double excess = 2.0 * green_sum - red - blue;
    const double total = 2.0 * green_sum + red + blue;
    neutral = red == green_sum && blue == green_sum;
    green = excess >= kGreenLeafIndex * total && total > 0;
    maybe_water = excess < kWaterGreenLeafIndex * total && blue >= red;
  }
};

CoverMasks cover_masks(const cv::Mat& pixels, const cv::Mat& gray, const cv::Mat& ground) {
  const auto zeros = [&] { return cv::Mat(gray.size(), CV_8U, cv::Scalar(0)); };
  CoverMasks masks{ground, zeros(), zeros(), zeros(), zeros()};
  const bool colored = pixels.channels() == 3;
  const cv::Mat counts = box_sum(ground, kSmoothBox_px);
  const cv::Mat sums = box_sum(gray, kSmoothBox_px);
  cv::Mat squares;
  cv::sqrBoxFilter(gray, squares, CV_32S, {kSmoothBox_px, kSmoothBox_px}, {-1, -1}, false, cv::BORDER_CONSTANT);
  cv::Mat colors;
  if (colored) colors = box_sum(pixels, kColorBox_px);
  for (int row = 0; row < gray.rows; ++row) {
    const auto* valid = ground.ptr<std::uint8_t>(row);
    for (int col = 0; col < gray.cols; ++col) {
      if (valid[col] == 0) continue;
      const Smoothness look(counts.at<int>(row, col), sums.at<int>(row, col), squares.at<int>(row, col));
      masks.gray_water.at<std::uint8_t>(row, col) = look.smooth && look.mean < kDarkGray;
      if (!colored) continue;
      const auto& rgb = colors.at<cv::Vec3i>(row, col);
      const Hue hue(rgb[0], rgb[1], rgb[2]);
      masks.neutral.at<std::uint8_t>(row, col) = hue.neutral;
      masks.green.at<std::uint8_t>(row, col) = hue.green;
      masks.water.at<std::uint8_t>(row, col) = look.smooth && look.mean < kDarkColored && hue.maybe_water;
    }
  }
  const cv::Mat ground_around = box_sum(ground, kMajorityBox_px);
  keep_majority(masks.gray_water, ground_around);
  if (!colored) return masks;
  keep_majority(masks.water, ground_around);
  masks.green.setTo(0, masks.water);
  return masks;
}

/// The structure tensor's entries, in whole numbers, so that sums are exact; 0 near what is no ground.
std::array<cv::Mat, 3> structure_tensor(const cv::Mat& gray, const cv::Mat& ground) {
  constexpr int kSide = 2 * kGradientReach_px + 1;
  cv::Mat deep;
  gray.convertTo(deep, CV_16U, 16);
  cv::GaussianBlur(deep, deep, {2 * kGradientReach_px - 1, 2 * kGradientReach_px - 1}, kGradientSigma_px);
  const cv::Mat whole = box_sum(ground, kSide);
  const cv::Mat reachable = box_sum(cv::Mat(ground.size(), CV_8U, cv::Scalar(1)), kSide);
  std::array<cv::Mat, 3> tensor;
  for (cv::Mat& entry : tensor) entry = cv::Mat(gray.size(), CV_64F, cv::Scalar(0));
  for (int row = 1; row + 1 < gray.rows; ++row) {
    for (int col = 1; col + 1 < gray.cols; ++col) {
      if (whole.at<int>(row, col) < reachable.at<int>(row, col)) continue;
      const double dx = int{deep.at<std::uint16_t>(row, col + 1)} - int{deep.at<std::uint16_t>(row, col - 1)};
      const double dy = int{deep.at<std::uint16_t>(row + 1, col)} - int{deep.at<std::uint16_t>(row - 1, col)};
      tensor[0].at<double>(row, col) = dx * dx;
      tensor[1].at<double>(row, col) = dx * dy;
      tensor[2].at<double>(row, col) = dy * dy;
    }
  }
  return tensor;
}

double eigenvalue_ratio(double xx, double xy, double yy) {
  const double trace = xx + yy;
  if (trace <= 0) return std::numeric_limits<double>::quiet_NaN();
  const double spread = std::hypot(xx - yy, 2 * xy);
  return std::max(0.0, trace - spread) / (trace + spread);
}

/// Everything that is summed over tiles, for one window.
class CoverSums {
 public:
  CoverSums(const cv::Mat& pixels, const cv::Mat& gray, const cv::Mat& ground)
      : CoverSums(pixels.channels() == 3, cover_masks(pixels, gray, ground), structure_tensor(gray, ground)) {}

  GroundCover of(const cv::Rect& tile) const {
    GroundCover cover;
    const double ground = ground_.at(tile);
    if (ground == 0) return cover;
    const bool colors = colored_ && neutral_.at(tile) < kNeutralShare * ground;
    cover.water_share = (colors ? water_ : gray_water_).at(tile) / ground;
    if (colors) cover.vegetation_share = green_.at(tile) / ground;
    cover.aperture = eigenvalue_ratio(xx_.at(tile), xy_.at(tile), yy_.at(tile));
    return cover;
  }

 private:
  CoverSums(bool colored, const CoverMasks& masks, const std::array<cv::Mat, 3>& tensor)
      : colored_(colored),
        ground_(masks.ground),
        neutral_(masks.neutral),
        green_(masks.green),
        water_(masks.water),
        gray_water_(masks.gray_water),
        xx_(tensor[0]),
        xy_(tensor[1]),
        yy_(tensor[2]) {}

  bool colored_;
  RectangleSums ground_, neutral_, green_, water_, gray_water_, xx_, xy_, yy_;
};

void check_request(const ColorSource& colors, const TileMatrix& matrix, std::span<const std::int64_t> indices) {
  if (matrix.grid_width_px != colors.width_px || matrix.grid_height_px != colors.height_px) {
    throw DataError("ground cover: the tile matrix is that of a grid of " + std::to_string(matrix.grid_width_px) +
                    " x " + std::to_string(matrix.grid_height_px) + " px, the imagery has " +
                    std::to_string(colors.width_px) + " x " + std::to_string(colors.height_px) + " px");
  }
  for (const std::int64_t index : indices) {
    if (index >= 0 && index < matrix.tile_count()) continue;
    throw UsageError("ground cover: tile index " + std::to_string(index) + " is outside [0, " +
                     std::to_string(matrix.tile_count() - 1) + "]");
  }
}

}  // namespace

double white_of(const ColorSource& colors) {
  return colors.depth == CV_8U ? 255 : std::max(find_stretch(gray_source_of(colors)).high, 1e-300);
}

std::vector<GroundCover> measure_ground_cover(const ColorSource& colors, const TileMatrix& matrix,
                                              std::span<const std::int64_t> tile_indices, int threads,
                                              const Progress& progress, std::optional<double> white) {
  check_request(colors, matrix, tile_indices);
  std::vector<std::int64_t> indices(tile_indices.begin(), tile_indices.end());
  if (indices.empty()) {
    indices.resize(static_cast<std::size_t>(matrix.tile_count()));
    std::iota(indices.begin(), indices.end(), 0);
  }
  if (!white) white = white_of(colors);
  std::vector<GroundCover> covers(indices.size());
  const std::vector<TileGroup> groups = group_tiles(matrix, indices, kHalo_px, colors.block_width_px);
  for_each_group(groups, "ground cover", threads, progress, [&](const TileGroup& group) {
    const Raster raster = colors.read(group.window);
    const cv::Mat pixels = to_8bit(raster, *white);
    const CoverSums sums(pixels, gray_from_colors(pixels), cv::Mat(raster.valid != 0) / 255);
    for (const std::size_t result_index : group.result_indices) {
      const PixelWindow tile = group.place_of(matrix.tile_window(matrix.cell_of(indices[result_index])));
      covers[result_index] = sums.of({static_cast<int>(tile.col), static_cast<int>(tile.row), tile.width, tile.height});
    }
  });
  return covers;
}

}  // namespace pilotage
