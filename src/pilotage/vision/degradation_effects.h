#pragma once

#include <vector>

#include <opencv2/core/mat.hpp>

#include "pilotage/base/random.h"

#pragma GCC visibility push(default)

namespace pilotage {

/// What can change on the ground between map and flight besides its fine texture, on CV_32F pictures of one channel of
/// any level and contrast: adding a constant or multiplying by a positive one commutes with each function. The sizes of
/// the effects are assumptions of the caller; docs/methods/degradation.md says what pairs of dates show.

/// A patch that shows another place of the same picture.
struct MovedObject {
  cv::Rect to;
  cv::Point from;  ///< Top left of what is shown there, same size as `to`.
  cv::Mat weight;  ///< CV_32F, size of `to`: 1 inside a rectangle turned at random, falling to 0 across one pixel.
};

/// Objects in a picture of size_px × size_px: on average `per_mpx` per million pixels, with two sides each uniform in
/// 0.5 … 1.5 of `object_size_px` (so they cover per_mpx·object_size_px²/1e6 of the ground, less their overlaps). What
/// they show lies one to four mean sides away where the picture has room. A picture too small for an object has none.
std::vector<MovedObject> draw_objects(int size_px, double per_mpx, double object_size_px, Random random);

/// Every object shows what stood at its `from` before any of them moved.
void move_objects(const std::vector<MovedObject>& objects, cv::Mat& picture);

/// How much each pixel looks like water, 0 … 1, from gray values alone: darker than the picture's mean by a quarter
/// (0) to three quarters (1) of its standard deviation, and with a local deviation (about 8 px) below 0.4 (0) to 0.2
/// (1) of it. Shadows and dark fields are taken for water too; a picture of water alone has no darker part and is not
/// recognised.
cv::Mat water_mask(const cv::Mat& picture);

/// Unit-variance field of ripples (sigma 1 px) and patches of wind (sigma 4 px).
cv::Mat water_field(int size_px, Random random);

/// Draws `share` (standard deviation, 0 … 1) of the water's structure anew: its mean over 12 px and the strength of the
/// deviations from it stay, the deviations become sqrt(1 − share²) of the old and `share` of `field`.
void redraw_water(double share, const cv::Mat& field, cv::Mat& picture);

/// How tall things are, 0 … 1, guessed from gray values alone: half what the local contrast exceeds its mean by, in
/// units of the mean, plus half what the local brightness exceeds its mean by, in standard deviations; at most 1,
/// smooth over `scale_px`. A homogeneous picture has almost no height.
cv::Mat guess_heights(const cv::Mat& picture, double scale_px);

}  // namespace pilotage

#pragma GCC visibility pop
