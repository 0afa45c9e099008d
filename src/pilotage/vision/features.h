#pragma once

#include <cstdint>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "pilotage/base/options.h"
#include "pilotage/base/progress.h"
#include "pilotage/geo/tile_matrix.h"
#include "pilotage/raster/gray_source.h"
#include "pilotage/vision/feature_set.h"

#pragma GCC visibility push(default)

namespace pilotage {

/// How features are found and described. Map and frame must agree in descriptor_bits and oriented.
struct FeatureOptions {
  double features_per_mpx = 20000;
  int descriptor_bits = 256;
  bool oriented = false;
  int fast_threshold = 20;
  int min_fast_threshold = 5;
  int octaves = 1;
  double scale_factor = 1.5;

  template <class Self, class Fields>
  static void describe(Self& self, Fields& fields) {
    fields.field("features_per_mpx", self.features_per_mpx,
                 "Most features for each million pixels, over all octaves; spread evenly.", Range{1, 200000});
    fields.field("descriptor_bits", self.descriptor_bits,
                 "Length of a descriptor: 128, 256 or 512. 256 is ORB's pattern, the others are BRIEF's.",
                 Range{128, 512});
    fields.field("oriented", self.oriented, "Turn descriptors with the patch, for frames whose heading is not known.");
    fields.field("fast_threshold", self.fast_threshold, "Contrast of a corner, gray levels.", Range{1, 254});
    fields.field("min_fast_threshold", self.min_fast_threshold,
                 "Contrast to fall back to where the ground is too faint for fast_threshold.", Range{1, 254});
    fields.field("octaves", self.octaves, "Number of scales.", Range{1, 12});
    fields.field("scale_factor", self.scale_factor, "Ratio of one octave's pixel size to the one before.",
                 Range{1.05, 2});
  }
};

/// Throws UsageError when an option is outside its range, when descriptor_bits is not 128, 256 or 512, when
/// min_fast_threshold > fast_threshold, or when the coarsest octave would shrink more than 64 times.
void check_feature_options(const FeatureOptions& options);

/// Pixels around a feature (in each direction, at its octave) on which its descriptor and orientation depend.
int patch_radius_px(const FeatureOptions& options);

/// Features of one image.
///
/// Corners are FAST-9 (E. Rosten, T. Drummond, ECCV 2006) with 3 × 3 non-maximum suppression at `fast_threshold`, in
/// cells of about eight features; a cell that does not fill its share is searched again at `min_fast_threshold`. In
/// each cell the corners with the highest Harris response (C. Harris, M. Stephens, 1988; 7 × 7 Sobel window, k = 0.04)
/// stay. Octaves are area averages of the image. Descriptors compare pixels of the image smoothed by a Gaussian of σ =
/// 2 px: 256 bits is the learned pattern of ORB (E. Rublee et al., ICCV 2011) as cv::ORB computes it; 128 and 512 bits
/// are pairs drawn from an isotropic Gaussian of variance S²/25, S = 31 px (M. Calonder et al., BRIEF, ECCV 2010,
/// layout G II). Upright descriptors have angle 0; oriented ones are turned by the angle of the intensity centroid (P.
/// L. Rosin, 1999) of a disc of 15 px radius.
///
/// `gray` is CV_8UC1 of any size; `valid` has its size (CV_8UC1, 0 = no data) or is empty, which means all valid. No
/// feature's patch touches an invalid pixel or leaves the image, so small images have none. Order: octave, then y, then
/// x. The result does not depend on the number of threads. Throws UsageError for options or matrices other than these.
FeatureSet extract_features(const cv::Mat& gray, const cv::Mat& valid, const FeatureOptions& options);

/// Features of a map of any size, each once, computed over fixed blocks of kFeatureBlockPx pixels with the margin that
/// patches need; positions are pixels of the whole grid. Only blocks that touch one of `windows` are read, and only
/// features inside at least one window are returned; the features of a piece of ground do not depend on the windows.
/// `threads` = 0 uses all cores and gives the same result as 1. Order: block (row by row), then octave, y, x. Memory: a
/// few megabytes per thread besides the result. Throws UsageError when the source is not CV_8U, when a window has a
/// negative size, or for bad options; what the source throws; Interrupted.
FeatureSet extract_features_of_map(const GraySource& source, const std::vector<PixelWindow>& windows,
                                   const FeatureOptions& options, int threads = 0, const Progress& progress = {});

inline constexpr int kFeatureBlockPx = 512;

}  // namespace pilotage

#pragma GCC visibility pop
