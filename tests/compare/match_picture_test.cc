#include "pilotage/compare/match_picture.h"

#include "compare/texture.h"
#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "pilotage/base/error.h"

namespace pilotage {
namespace {

// Pixels of exactly one colour.
int pixels_of(const cv::Mat& bgr, const cv::Scalar& color) {
  cv::Mat found;
  cv::inRange(bgr, color, color, found);
  return cv::countNonZero(found);
}

const cv::Scalar kBlue(178, 114, 0);
const cv::Scalar kOrange(0, 94, 213);
const cv::Scalar kYellow(66, 228, 240);

TEST(MatchPicture, RightAndWrongMatchesDifferInColourAndStroke) {
  const cv::Mat frame = testing::texture(300, 200, 1);
  const cv::Mat reference = testing::texture(500, 400, 2);
  const cv::Mat none = draw_matches("SIFT", {frame, {}}, {reference, {}}, {}, 5);
  const cv::Mat right = draw_matches("SIFT", {frame, {}}, {reference, {}}, {{{150, 100}, {250, 200}, true}}, 5);
  const cv::Mat wrong = draw_matches("SIFT", {frame, {}}, {reference, {}}, {{{150, 100}, {250, 200}, false}}, 5);
  const int blue = pixels_of(right, kBlue) - pixels_of(none, kBlue);
  const int orange = pixels_of(wrong, kOrange) - pixels_of(none, kOrange);
  EXPECT_GT(blue, 100);
  EXPECT_GT(orange, 100);
  EXPECT_LT(orange, 0.8 * blue);  // dashed
  EXPECT_EQ(pixels_of(right, kOrange), pixels_of(none, kOrange));
  EXPECT_EQ(pixels_of(wrong, kBlue), pixels_of(none, kBlue));
}

TEST(MatchPicture, EachFeatureIsADotOnItsSide) {
  const cv::Mat gray(300, 400, CV_8UC1, cv::Scalar(90));
  const cv::Mat none = draw_matches("ORB", {gray, {}}, {gray, {}}, {}, 5);
  const cv::Mat dotted = draw_matches("ORB", {gray, {{10.5, 20.5}, {399.4, 299.4}}}, {gray, {{200, 150}}}, {}, 5);
  EXPECT_EQ(pixels_of(dotted, kYellow) - pixels_of(none, kYellow), 3 * 4);
  // Both sides are drawn at 794/400 = 1.985 of their size, below a title of 60 px.
  EXPECT_EQ(dotted.at<cv::Vec3b>(60 + 40, 20), cv::Vec3b(66, 228, 240));
  EXPECT_EQ(dotted.at<cv::Vec3b>(60 + 297, 794 + 12 + 397), cv::Vec3b(66, 228, 240));
}

TEST(MatchPicture, FitsAPageWhateverTheImages) {
  for (const auto& [frame_size, reference_size] :
       {std::pair{cv::Size(4004, 2662), cv::Size(900, 900)}, std::pair{cv::Size(1, 1), cv::Size(3000, 1)},
        std::pair{cv::Size(20, 5000), cv::Size(30, 40)}}) {
    const cv::Mat frame(frame_size, CV_8UC1, cv::Scalar(80));
    const cv::Mat reference(reference_size, CV_8UC1, cv::Scalar(120));
    const cv::Mat picture = draw_matches("ORB", {frame, {}}, {reference, {}}, {{{0.5, 0.5}, {0.5, 0.5}, true}}, 5);
    EXPECT_LE(picture.cols, 1600);
    EXPECT_LE(picture.rows, 1000);
    EXPECT_EQ(picture.type(), CV_8UC3);
    EXPECT_EQ(png_bytes(picture).substr(1, 3), "PNG");
  }
}

TEST(MatchPicture, RefusesOtherImages) {
  const cv::Mat gray(10, 10, CV_8UC1, cv::Scalar(0));
  EXPECT_THROW(draw_matches("ORB", {cv::Mat(), {}}, {gray, {}}, {}, 5), UsageError);
  EXPECT_THROW(draw_matches("ORB", {gray, {}}, {cv::Mat(10, 10, CV_8UC3), {}}, {}, 5), UsageError);
}

}  // namespace
}  // namespace pilotage
