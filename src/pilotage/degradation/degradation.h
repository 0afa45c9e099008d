#pragma once

#include <cstdint>

#include <opencv2/core/mat.hpp>

#include "pilotage/base/options.h"

#pragma GCC visibility push(default)

namespace pilotage {

/// How much another day, another sensor and an imperfect rectification change the picture of the same ground
/// (docs/methods/uniqueness.md). 0 switches an effect off, to the byte. What real pairs of dates say of each stands in
/// docs/methods/degradation.md. Sizes in pixels are those of the tile at hand.
struct DegradationOptions {
  double rotation_deg = 2;
  double scale_percent = 3;
  double texture_redrawn = 0.65;
  double texture_scale_px = 3;
  double illumination = 0.15;
  double gamma = 0.2;
  double blur_px = 0.7;
  double noise = 0.05;

  template <class Self, class Fields>
  static void describe(Self& self, Fields& fields) {
    fields.field("rotation_deg", self.rotation_deg, "Rotation about the tile's centre, either way.", Range{0, 45});
    fields.field("scale_percent", self.scale_percent, "Change of scale, up or down.", Range{0, 30});
    fields.field("texture_redrawn", self.texture_redrawn,
                 "Share of the fine texture (standard deviation) that is drawn anew with random phase.", Range{0, 1});
    fields.field("texture_scale_px", self.texture_scale_px,
                 "Structures finer than this Gaussian sigma count as texture.", Range{0.5, 64});
    fields.field("illumination", self.illumination,
                 "Amplitude of a smooth brightness factor across the tile: it runs from 1 - this to 1 + this.",
                 Range{0, 0.9});
    fields.field("gamma", self.gamma, "Exponent of the tone curve: 1/(1 + this) or 1 + this.", Range{0, 2});
    fields.field("blur_px", self.blur_px, "Sigma of a Gaussian blur.", Range{0, 16});
    fields.field("noise", self.noise, "Sigma of white noise, in standard deviations of the tile.", Range{0, 4});
  }
};

/// A degraded copy of `tile` (CV_32F, one channel, any level and contrast) as CV_32F of the same size: what a camera
/// might see of it on another day. In this order, from the ground up to the sensor: rotation and scale (one
/// interpolation); fine texture partly drawn anew (random phase, the local strength of the old one; coarse structure
/// stays); illumination; tone curve, blur, noise.
///
/// Effects of brightness act on gray values scaled to 0 (darkest pixel) … 1 (brightest), and then the copy stays in
/// this scale; without them it keeps the tile's.
///
/// Rotation, scale and tone take their full stated size with alternating sign: copy 0 and 1 differ in all signs, and
/// every tile meets the same change, so that scores compare tiles and not luck. Fields and directions are drawn from
/// (seed, copy), each effect from its own stream: switching one on changes no draw of another.
///
/// `tile` may be larger than the result: `margin_px` pixels on each side are context for the geometry and are cut off,
/// so that no border has to be invented when the margin is at least rotation_margin_px. Pixels beyond are mirrored.
/// Throws UsageError on another type, options out of range, or nothing left after the margin.
class Degrader {
 public:
  /// Prepares the fields for tiles of `tile_size_px`; `copy` counts from 0.
  Degrader(int tile_size_px, int margin_px, const DegradationOptions& options, std::uint64_t seed, int copy);

  /// `tile` has side tile_size_px + 2·margin_px. May be called by several threads at a time.
  cv::Mat apply(const cv::Mat& tile) const;

 private:
  cv::Mat seen(const cv::Mat& tile) const;       // geometry
  cv::Mat redrawn(const cv::Mat& ground) const;  // fine texture

  DegradationOptions options_;
  int size_px_;
  int margin_px_;
  double gamma_ = 1;
  cv::Mat map_xy_;        // CV_32FC2: where each pixel of the copy lies in the tile
  cv::Mat texture_;       // unit-variance random field with the band of fine texture
  cv::Mat illumination_;  // factor field around 1
  cv::Mat noise_;         // unit-variance white field
};

/// Context that geometry (rotation and scale about the centre) needs on each side, whole pixels.
int rotation_margin_px(int tile_size_px, const DegradationOptions& options);

}  // namespace pilotage

#pragma GCC visibility pop
