#pragma once

#include <opencv2/core/mat.hpp>

#include "pilotage/base/random.h"

// What spoils a frame between the ground and the matcher: weather, light, the lens, the link. Each is a model of one
// effect in the field's own units, for what the matcher makes of it, not for looks; its constants are assumptions, and
// docs/methods/rendered-flights.md says what each leaves out. Frames are CV_8UC1 of 16 pixels and more to each side.

namespace pilotage {

/// Fog of a meteorological optical range `visibility_m` > 0 between the ground and a camera `way_m` above it: of the
/// ground's light 0.05^(way/visibility) comes through (H. Koschmieder, Beiträge zur Physik der freien Atmosphäre 12,
/// 1924; the range as WMO-No. 8 defines it), the rest is bright fog. What is left of the contrast meets the noise of a
/// sensor, kSensorNoise of full scale.
void add_fog(cv::Mat& gray, double way_m, double visibility_m, Random random);

/// Clouds below the aircraft that hide the share `cover`, 0 … 1, of the frame, to a hundredth where what is half hidden
/// counts as half. Edges are half transparent; patches are a fifth of the frame's width across at a cover of 0.2, and
/// grow together above.
void add_clouds(cv::Mat& gray, double cover, Random random);

/// A frame taken with `stops` factors of two less light than a full exposure, gain turned up as much: shot noise of
/// kFullWell_e electrons at full scale in daylight, read noise of kReadNoise_e electrons.
void take_in_the_dark(cv::Mat& gray, double stops, Random random);

/// `drops` drops of water on the lens, each a disc of 2 to 6 % of the frame's width with a sharp edge, through which
/// the ground is blurred by 2 % of the width and a little brighter.
void add_drops(cv::Mat& gray, int drops, Random random);

/// The frame after a link that compresses it to JPEG of `quality`, 1 … 100.
void compress(cv::Mat& gray, int quality);

inline constexpr double kSensorNoise = 0.005;
inline constexpr double kFullWell_e = 10'000;
inline constexpr double kReadNoise_e = 4;

}  // namespace pilotage
