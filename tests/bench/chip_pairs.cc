// How often a small picture of one date is found in a picture of another date of the same ground: chips without
// heights, cameras and priors. docs/decisions/chips.md has the results.
//
//   bench_chip_pairs SIDE_PX FIRST SECOND [FIRST SECOND]...
//
// Of each pair, registered pixel by pixel, 20 squares of SIDE_PX of the second picture at random places, turned by 1°
// and scaled by 3 % (one sigma), are searched in the whole first one under nine hypotheses. Right is a place within 5
// px.

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <numbers>
#include <string>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/random.h"
#include "pilotage/build_map/build_chips.h"
#include "pilotage/match/chip_search.h"
#include "pilotage/raster/gdal_gray.h"
#include "pilotage/vision/direction_field.h"

namespace pilotage {
namespace {

constexpr int kSquares = 20;

ChipMosaic chips_of(const cv::Mat& gray) {
  cv::Mat grown;
  constexpr int kMore = kDirectionReachPx;
  cv::copyMakeBorder(gray, grown, kMore, kMore, kMore, kMore, cv::BORDER_REFLECT);
  const ChipPicture picture = make_chip_picture(grown, cv::Mat(grown.size(), CV_8UC1, cv::Scalar(255)), 1);
  return {picture.steps, picture.valid, 0, 0, 1};
}

/// The square about `center` that must be turned by yaw_deg and scaled by `scale` to lie on the picture again.
RectifiedFrame square_about(const cv::Mat& gray, const Eigen::Vector2d& center, int side, double yaw_deg,
                            double scale) {
  const double turn = yaw_deg * std::numbers::pi / 180;
  const double c = scale * std::cos(turn);
  const double s = scale * std::sin(turn);
  const double first = 0.5 - side / 2.0;
  const cv::Matx23d map(c, -s, center.x() + c * first - s * first - 0.5, s, c,
                        center.y() + s * first + c * first - 0.5);
  RectifiedFrame frame;
  frame.status = RectifyStatus::kOk;
  frame.gsd_m = 1;
  frame.origin_m = {-side / 2.0, side / 2.0};
  cv::warpAffine(gray, frame.gray, map, {side, side}, cv::INTER_LINEAR | cv::WARP_INVERSE_MAP, cv::BORDER_REFLECT);
  frame.valid = cv::Mat(side, side, CV_8UC1, cv::Scalar(255));
  return frame;
}

struct Count {
  int squares = 0;
  int right = 0;  // within 5 px
  int near = 0;   // within 20 px
};

void search_pair(const std::string& first, const std::string& second, int side, Random& random, Count& count) {
  const cv::Mat map = read_gray8_picture(first);
  const cv::Mat seen = read_gray8_picture(second);
  if (map.size() != seen.size()) throw DataError(first + " and " + second + " differ in size");
  const double margin = 0.55 * side;
  if (std::min(map.cols, map.rows) <= 2 * margin) throw DataError(first + " is too small for squares of that size");
  const ChipMosaic mosaic = chips_of(map);
  for (int i = 0; i < kSquares; ++i) {
    const Eigen::Vector2d truth(random.uniform(margin, map.cols - margin), random.uniform(margin, map.rows - margin));
    const RectifiedFrame frame = square_about(seen, truth, side, random.normal(), 1 + 0.03 * random.normal());
    const auto matches = search_chips(make_chip_frame(frame), mosaic, {map.cols / 2.0, map.rows / 2.0},
                                      std::max(map.cols, map.rows) / 2.0, chip_hypotheses(1.5, 3, 0.04, 3));
    ++count.squares;
    if (matches.empty()) continue;
    const double error_px = (matches.front().nadir_px - truth).norm();
    count.right += error_px <= 5 ? 1 : 0;
    count.near += error_px <= 20 ? 1 : 0;
  }
}

void measure(int argc, char** argv) {
  if (argc < 4 || argc % 2 != 0) throw UsageError("bench_chip_pairs SIDE_PX FIRST SECOND [FIRST SECOND]...");
  Random random(seed_from_name("bench_chip_pairs"));
  Count count;
  for (int i = 2; i < argc; i += 2) search_pair(argv[i], argv[i + 1], std::atoi(argv[1]), random, count);
  std::printf("%d squares of %s px: right within 5 px %.1f %%, within 20 px %.1f %%\n", count.squares, argv[1],
              100.0 * count.right / count.squares, 100.0 * count.near / count.squares);
}

}  // namespace
}  // namespace pilotage

int main(int argc, char** argv) {
  try {
    cv::setNumThreads(1);
    pilotage::measure(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "bench_chip_pairs: %s\n", error.what());
    return 1;
  }
  return 0;
}
