#pragma once

#include <optional>
#include <vector>

#include "pilotage/base/options.h"
#include "pilotage/compare/descriptor_method.h"
#include "pilotage/mission/frame_table.h"
#include "pilotage/raster/gdal_imagery.h"

namespace pilotage {

/// What is compared, and what counts as right. The fix is found and judged alike for every method, so that only
/// features and descriptors differ.
struct CompareOptions {
  std::vector<DescriptorMethod> methods{
      DescriptorMethod::kOrb,       DescriptorMethod::kGround64, DescriptorMethod::kGround128,
      DescriptorMethod::kGround256, DescriptorMethod::kOrb256,   DescriptorMethod::kBrief128,
      DescriptorMethod::kBrief512,  DescriptorMethod::kSift,     DescriptorMethod::kSurf};
  bool raw = false;
  std::optional<double> gsd_m;
  double search_sigmas = 3;
  int max_features = 1500;
  double tolerance_m = 5;
  double correct_within_m = 5;
  double ratio = 0.8;
  double ransac_threshold_px = 3;
  int min_inliers = 6;
  double max_scale_error = 0.25;
  FrameTruth truth = FrameTruth::kCenter;
  int picture_frame = 1;
  ImageryOptions imagery;

  template <class Self, class Fields>
  static void describe(Self& self, Fields& fields) {
    fields.field("methods", self.methods, "Which are compared, in the order of the table.");
    fields.field("raw", self.raw,
                 "Match the frame as the camera made it; otherwise it is laid on the ground, north up, with the known "
                 "attitude and height.");
    fields.field("gsd_m", self.gsd_m,
                 "Ground length of a pixel of the reference. Default: 0.6, or the imagery's own where that is coarser; "
                 "with raw the imagery's own.",
                 Range{0.001, 1000});
    fields.field("search_sigmas", self.search_sigmas,
                 "The reference reaches this many standard deviations of the prior beyond the frame's footprint.",
                 Range{0.5, 10});
    fields.field("max_features", self.max_features,
                 "Most features of a frame; the reference gets as many for the same area of ground.",
                 Range{10, 100000});
    fields.field("tolerance_m", self.tolerance_m, "A match agrees with the truth within this.", Range{0.01, 10000});
    fields.field("correct_within_m", self.correct_within_m, "A fix is correct within this.", Range{0.01, 10000});
    fields.field("ratio", self.ratio,
                 "A match takes part in the fix when its distance is below this share of the second best one's.",
                 Range{0.1, 1});
    fields.field("ransac_threshold_px", self.ransac_threshold_px,
                 "An inlier lies this near to where the transform puts it, pixels of the reference.", Range{0.1, 100});
    fields.field("min_inliers", self.min_inliers, "A fix is accepted from this many inliers on.", Range{2, 100000});
    fields.field("max_scale_error", self.max_scale_error,
                 "A fix is refused when its scale differs from that of height and camera by more than this share.",
                 Range{0.001, 10});
    fields.field(
        "truth", self.truth,
        "Which point frames are compared at, and what true_lon_deg and true_lat_deg are without true_nadir_lon_deg.");
    fields.field("picture_frame", self.picture_frame, "Row of the frame that the pictures show, from 1; 0 for none.",
                 Range{0, 1e9});
    ImageryOptions::describe(self.imagery, fields);
  }
};

}  // namespace pilotage
