#include "pilotage/raster/rectangle_sums.h"

#include <opencv2/imgproc.hpp>

namespace pilotage {

RectangleSums::RectangleSums(const cv::Mat& values) {
  cv::integral(values, sums_, values.depth() == CV_8U ? CV_32S : CV_64F);
}

double RectangleSums::at(const cv::Rect& rectangle) const {
  return value(rectangle.y, rectangle.x) - value(rectangle.y, rectangle.br().x) - value(rectangle.br().y, rectangle.x) +
         value(rectangle.br().y, rectangle.br().x);
}

double RectangleSums::value(int row, int col) const {
  return sums_.depth() == CV_32S ? sums_.at<int>(row, col) : sums_.at<double>(row, col);
}

cv::Mat box_sum(const cv::Mat& values, int side_px) {
  cv::Mat sums;
  cv::boxFilter(values, sums, CV_32S, {side_px, side_px}, {-1, -1}, false, cv::BORDER_CONSTANT);
  return sums;
}

}  // namespace pilotage
