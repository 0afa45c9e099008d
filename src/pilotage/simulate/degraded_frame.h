#pragma once

#include <cstdint>
#include <optional>

#include <opencv2/core/mat.hpp>

#include "pilotage/degradation/degradation.h"

namespace pilotage {

/// Changes the frames of one flight as another day and another sensor might (degradation/degradation.h), by `strength`
/// times its defaults, in gray values alone: where a frame is, its pose says.
class FrameDegrader {
 public:
  FrameDegrader(double strength, std::uint64_t seed) : strength_(strength), seed_(seed) {}

  /// CV_8UC1, always of the same size.
  void apply(cv::Mat& gray);

 private:
  double strength_;
  std::uint64_t seed_;
  std::optional<Degrader> degrader_;  ///< Made for the first frame.
};

}  // namespace pilotage
