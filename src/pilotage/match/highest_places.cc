#include "pilotage/match/highest_places.h"

#include <opencv2/core.hpp>

namespace pilotage {

std::vector<cv::Point> highest_places(const cv::Mat& surface, std::size_t count, int exclusion) {
  cv::Mat left = surface.clone();
  std::vector<cv::Point> places;
  while (places.size() < count) {
    double highest = 0;
    cv::Point at;
    cv::minMaxLoc(left, nullptr, &highest, nullptr, &at);
    if (highest <= 0) break;
    places.push_back(at);
    const cv::Rect around(at.x - exclusion, at.y - exclusion, 2 * exclusion + 1, 2 * exclusion + 1);
    left(around & cv::Rect({0, 0}, left.size())).setTo(0);
  }
  return places;
}

}  // namespace pilotage
