#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "pilotage/geo/tile_matrix.h"

namespace pilotage {

/// What a pixel is to the search for a collar.
enum class CollarColor : std::uint8_t {
  kNone,   ///< Ground, or anything else.
  kBlack,  ///< 0 in every band.
  kWhite,  ///< The type's largest value in every band: 255 or 65535.
};

/// A region of one colour that reaches in from the edge of a raster is a collar when it has at least this many pixels
/// (a sixteenth of a tile of 256 px) …
inline constexpr std::int64_t kLeastCollarPixels = 4096;
/// … and at least this many for each pixel of the edge that it touches. What is thinner takes less than 3 % of a tile
/// of 256 px: it changes no score, and a saturated roof or a shadow at the edge is not meant.
inline constexpr std::int64_t kLeastCollarDepth_px = 8;

/// The part of a raster that is a frame around the ground rather than ground: left over where imagery was turned,
/// reprojected or cut without a no-data value.
struct Collar {
  /// Pixels [begin, end) of one row.
  struct Run {
    int begin = 0;
    int end = 0;
  };
  int width_px = 0;
  std::vector<std::size_t>
      row_starts;         ///< Row r holds runs[row_starts[r]] to runs[row_starts[r + 1]], one more at the end.
  std::vector<Run> runs;  ///< Ascending within a row; they do not touch those of the same colour.
  std::int64_t black_px = 0;
  std::int64_t white_px = 0;

  int height_px() const { return static_cast<int>(row_starts.size()) - 1; }
  /// Share of the raster's pixels, 0 … 1.
  double share() const;
  /// Sets the pixels of `valid` (CV_8U, the window's size) that lie in the collar to 0.
  void clear(const PixelWindow& window, cv::Mat& valid) const;
};

/// Finds the collar of a raster whose rows come one by one, from the top: regions of pixels of one colour that hang
/// together by their sides and reach the raster's edge. Keeps runs of pixels, never the pixels: its memory grows with
/// the raggedness of what is black or white, not with the raster's area.
class CollarSearch {
 public:
  /// Runs that are kept at most, of edge and inside together; 8 million take 100 MB.
  static constexpr std::size_t kMostRuns = std::size_t{1} << 23;

  CollarSearch(int width_px, int height_px, std::size_t most_runs = kMostRuns);

  /// The next row, `width_px` colours. False when there are more runs than are kept: what is so ragged is texture.
  bool add_row(std::span<const CollarColor> row);

  /// After the last row: nothing where no region is a collar.
  std::optional<Collar> finish();

 private:
  struct LabeledRun {
    Collar::Run run;
    std::int32_t region = 0;
  };
  struct Region {
    std::int32_t parent = 0;  // itself, or the region that it turned out to be part of
    CollarColor color = CollarColor::kNone;
    std::int64_t pixels = 0;
    std::int64_t edge_pixels = 0;
  };
  std::int32_t root_of(std::int32_t region);
  std::int32_t join(std::int32_t a, std::int32_t b);
  void add_run(const Collar::Run& run, CollarColor color, std::size_t& above, std::size_t above_end);

  int width_px_;
  int height_px_;
  std::size_t most_runs_;
  std::vector<std::size_t> row_starts_{0};
  std::vector<LabeledRun> runs_;
  std::vector<Region> regions_;
};

}  // namespace pilotage
