#include "pilotage/vision/picture_spectra.h"

#include <opencv2/core.hpp>

namespace pilotage {

PictureSpectra::PictureSpectra(const cv::Size& largest)
    : size_(cv::getOptimalDFTSize(largest.width), cv::getOptimalDFTSize(largest.height)) {}

cv::Mat PictureSpectra::spectrum(const cv::Mat& pixels) const {
  cv::Mat padded = cv::Mat::zeros(size_, CV_32F);
  pixels.copyTo(padded(cv::Rect({0, 0}, pixels.size())));
  cv::dft(padded, padded, 0, pixels.rows);
  return padded;
}

cv::Mat PictureSpectra::product(const cv::Mat& large_spectrum, const cv::Mat& small_spectrum) {
  cv::Mat result;
  cv::mulSpectrums(large_spectrum, small_spectrum, result, 0, true);
  return result;
}

cv::Mat PictureSpectra::pixels(cv::Mat& spectrum, const cv::Rect& rect) {
  cv::dft(spectrum, spectrum, cv::DFT_INVERSE | cv::DFT_SCALE | cv::DFT_REAL_OUTPUT, rect.y + rect.height);
  return spectrum(rect);
}

}  // namespace pilotage
