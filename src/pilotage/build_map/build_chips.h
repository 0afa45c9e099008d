#pragma once

#include <cstdint>
#include <vector>

#include "pilotage/base/options.h"
#include "pilotage/base/progress.h"
#include "pilotage/build_map/tile_owner.h"
#include "pilotage/ground/ground.h"
#include "pilotage/mapdb/chip_codec.h"
#include "pilotage/mapdb/map_writer.h"
#include "pilotage/raster/gray_source.h"

#pragma GCC visibility push(default)

namespace pilotage {

/// Whether and how chips are stored beside the descriptors. The defaults are those that docs/decisions/chips.md
/// measures.
struct ChipOptions {
  bool chips = false;
  double chip_gsd_m = 0.6;

  template <class Self, class Fields>
  static void describe(Self& self, Fields& fields) {
    fields.field("chips", self.chips, "Store the directions of each tile's edges, too, for matching by correlation.");
    fields.field("chip_gsd_m", self.chip_gsd_m,
                 "Ground length of a chip's pixel; the nearest whole multiple of the level's pixel is taken.",
                 Range{0.1, 100});
  }
};

/// The chip of a window of a level without what no edge can be told of, the `margin` pixels of the chip all around:
/// gray values are averaged over the valid pixels of each square of `factor` × `factor`, valid where at least half of
/// it is, and their direction_field() taken in steps. `gray` and `valid` are CV_8UC1 of one size, whose sides are
/// multiples of `factor`. Throws UsageError otherwise.
ChipPicture make_chip_picture(const cv::Mat& gray, const cv::Mat& valid, int factor);

/// Side of a chip's pixel in pixels of a level with `gsd_m`: 1 … kMaxChipFactor.
int chip_factor(const ChipOptions& options, double gsd_m);

/// The most bytes that chips can take per pixel of a level with `gsd_m`; 0 when there are none.
double chip_bytes_per_px(const ChipOptions& options, double gsd_m);

struct ChipStats {
  std::int64_t chips = 0;
  std::int64_t bytes = 0;
};

/// Writes the chips of the selected `tiles` of one level (ascending tile_id). Chips share one grid of pixels, which
/// begins at pixel (0, 0) of the level, and each of its pixels is stored by the tile that owns its centre: so every
/// piece of ground is stored once, and the chips around a place put together show all selected ground there. A tile's
/// chip is cut to the pixels it owns; a tile that owns no ground has none. `source` is the level's imagery, CV_8U; it
/// is read once more, a tile at a time. The same rows for any number of threads. Throws what the source and the writer
/// throw; Interrupted.
ChipStats write_chips(MapWriter& writer, const GridLevel& level, const std::vector<const GroundTile*>& tiles,
                      const TileOwner& owner, const GraySource& source, const ChipOptions& options, int threads,
                      const Progress& progress);

}  // namespace pilotage

#pragma GCC visibility pop
