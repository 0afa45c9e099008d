#pragma once

#include <cstdint>

#include <opencv2/core/mat.hpp>

namespace pilotage::testing {

/// Ground that nothing else looks like: smoothed noise on scales from 2 to 16 px, gray values 0 … 255.
cv::Mat texture(int width_px, int height_px, std::uint64_t seed);

}  // namespace pilotage::testing
