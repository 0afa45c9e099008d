#pragma once

#include <opencv2/core/mat.hpp>

namespace pilotage {

/// Transforms of pictures of at most one size by OpenCV, for correlating small ones with a large one.
class PictureSpectra {
 public:
  explicit PictureSpectra(const cv::Size& largest);

  /// Of CV_32FC1 pixels, as if 0 stood beside them.
  cv::Mat spectrum(const cv::Mat& pixels) const;
  /// Whose pixels are Σ small·large at every position of the small picture in the large one. Products may be added.
  static cv::Mat product(const cv::Mat& large_spectrum, const cv::Mat& small_spectrum);
  /// These pixels of a spectrum. Takes the place of the spectrum's numbers.
  static cv::Mat pixels(cv::Mat& spectrum, const cv::Rect& rect);

 private:
  cv::Size size_;
};

}  // namespace pilotage
