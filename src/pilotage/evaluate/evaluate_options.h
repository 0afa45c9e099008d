#pragma once

#include <optional>
#include <string>

#include "pilotage/base/options.h"
#include "pilotage/mission/frame_table.h"

namespace pilotage {

/// What looks for the ground of the other date in the map.
enum class EvaluateMatcher {
  kVoting,  ///< match(), which flies: frames are rendered from the other date.
  kNcc,     ///< Normalised correlation of the other date's tile with the scored imagery, which refuses nothing.
};

inline EnumNames<EvaluateMatcher> enum_names(EvaluateMatcher) {
  return {{EvaluateMatcher::kVoting, "voting"}, {EvaluateMatcher::kNcc, "ncc"}};
}

/// How scores are held against what a matcher finds on another date. The defaults' reasons: docs/methods/evaluation.md.
struct EvaluateOptions {
  std::string file;
  std::string frames;
  FrameTruth frames_truth = FrameTruth::kCenter;
  EvaluateMatcher matcher = EvaluateMatcher::kVoting;
  bool chips = false;
  std::optional<double> tolerance_m;
  int stride = 1;
  int max_tiles = 0;
  double attitude_sigma_deg = 1;
  double height_sigma_fraction = 0.03;
  double block_tiles = 4;
  int bins = 10;
  int resamples = 1000;
  std::optional<double> stated_rate;

  template <class Self, class Fields>
  static void describe(Self& self, Fields& fields) {
    fields.path("file", self.file, "Imagery of another date: hold the scores against what a matcher finds on it.");
    fields.path("frames", self.frames, "Instead: real frames with their truth (frames.csv), matched as in flight.");
    fields.field(
        "frames_truth", self.frames_truth,
        "What true_lon_deg and true_lat_deg of the frames are. Beside true_nadir_lon_deg they are the centre.");
    fields.field(
        "matcher", self.matcher,
        "voting: the matcher that flies, on frames rendered from the other date; ncc: normalised correlation.");
    fields.field("chips", self.chips, "The matcher's map has chips.");
    fields.field("tolerance_m", self.tolerance_m,
                 "A place is correct within this. Default: 3 m, or 5 pixels where these are more; ncc: 1.5 pixels.",
                 Range{0.001, 10000});
    fields.field("stride", self.stride, "Judge every n-th tile along columns and rows.", Range{1, 10000});
    fields.field("max_tiles", self.max_tiles, "Judge at most so many tiles, drawn by the seed; 0 for all.",
                 Range{0, 1e9});
    fields.field("attitude_sigma_deg", self.attitude_sigma_deg,
                 "Standard deviation of the error of yaw, pitch and roll.", Range{0.01, 20});
    fields.field("height_sigma_fraction", self.height_sigma_fraction,
                 "Standard deviation of the error of the height, as a share of it.", Range{1e-4, 0.5});
    fields.field("block_tiles", self.block_tiles,
                 "Intervals re-draw whole square blocks of ground: their side, in sides of a tile.", Range{0.01, 1e6});
    fields.field("bins", self.bins, "Bins of the calibration error.", Range{1, 1000});
    fields.field("resamples", self.resamples, "Resamples behind the intervals; 0 for none.", Range{0, 100000});
    fields.field("stated_rate", self.stated_rate, "Also take the Brier skill against this share of correct fixes.",
                 Range{0, 1});
  }

  bool wanted() const { return !file.empty() || !frames.empty(); }
};

}  // namespace pilotage
