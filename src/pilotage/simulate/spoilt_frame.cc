#include "pilotage/simulate/spoilt_frame.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "pilotage/base/error.h"
#include "pilotage/degradation/degradation_fields.h"

namespace pilotage {
namespace {

constexpr float kFogGray = 200;
constexpr float kCloudGray = 235;
constexpr double kDropGain = 1.15;

/// The value that a share of a field lies above; a quantile without a copy that is sorted, of 200,000 values.
float value_above(const cv::Mat& field, double share) {
  std::vector<float> values(field.begin<float>(), field.end<float>());
  const auto rank = static_cast<std::ptrdiff_t>(std::lround((1 - share) * static_cast<double>(values.size() - 1)));
  std::nth_element(values.begin(), values.begin() + rank, values.end());
  return values[static_cast<std::size_t>(rank)];
}

}  // namespace

void add_fog(cv::Mat& gray, double way_m, double visibility_m, Random random) {
  const double through = std::pow(0.05, way_m / visibility_m);
  cv::Mat seen;
  gray.convertTo(seen, CV_32F, through, (1 - through) * kFogGray);
  seen += 255 * kSensorNoise * white_field(gray.size(), random);
  seen.convertTo(gray, CV_8U);
}

void add_clouds(cv::Mat& gray, double cover, Random random) {
  if (cover <= 0) return;
  if (cover >= 1) {
    gray.setTo(kCloudGray);
    return;
  }
  // Patches of a fifth of the width and more are smooth on a grid of 64 px.
  const double reduction = std::max(1.0, gray.cols / 64.0);
  const cv::Size coarse(std::max(1, static_cast<int>(std::lround(gray.cols / reduction))),
                        std::max(1, static_cast<int>(std::lround(gray.rows / reduction))));
  cv::Mat field = white_field(coarse, random);
  cv::GaussianBlur(field, field, {}, coarse.width / 12.0, 0, cv::BORDER_REFLECT_101);
  cv::resize(field, field, gray.size(), 0, 0, cv::INTER_CUBIC);
  cv::Scalar mean;
  cv::Scalar sigma;
  cv::meanStdDev(field, mean, sigma);
  const double edge = 0.15 * sigma[0];
  const double at_edge = value_above(field, cover);
  cv::Mat opacity = (field - (at_edge - edge)) / (2 * edge);  // one half where the cloud ends
  opacity = cv::max(cv::min(opacity, 1), 0);
  cv::Mat seen;
  gray.convertTo(seen, CV_32F);
  seen += opacity.mul(kCloudGray - seen);
  seen.convertTo(gray, CV_8U);
}

void take_in_the_dark(cv::Mat& gray, double stops, Random random) {
  const double electrons_per_gray = kFullWell_e / std::exp2(stops) / 255;
  for (int row = 0; row < gray.rows; ++row) {
    auto* line = gray.ptr<std::uint8_t>(row);
    for (int col = 0; col < gray.cols; ++col) {
      const double electrons = line[col] * electrons_per_gray;
      const double counted = electrons + std::hypot(std::sqrt(electrons), kReadNoise_e) * random.normal();
      line[col] = cv::saturate_cast<std::uint8_t>(counted / electrons_per_gray);
    }
  }
}

void add_drops(cv::Mat& gray, int drops, Random random) {
  const double width_px = gray.cols;
  cv::Mat through;
  cv::GaussianBlur(gray, through, {}, std::max(1.0, 0.02 * width_px), 0, cv::BORDER_REFLECT_101);
  through.convertTo(through, CV_8U, kDropGain);
  cv::Mat wet = cv::Mat::zeros(gray.size(), CV_8UC1);
  for (int drop = 0; drop < drops; ++drop) {
    const cv::Point middle(static_cast<int>(random.uniform() * gray.cols),
                           static_cast<int>(random.uniform() * gray.rows));
    const int radius_px = static_cast<int>(std::lround(random.uniform(0.01, 0.03) * width_px));
    cv::circle(wet, middle, std::max(1, radius_px), 255, cv::FILLED);
  }
  through.copyTo(gray, wet);
}

void compress(cv::Mat& gray, int quality) {
  std::vector<std::uint8_t> bytes;
  if (!cv::imencode(".jpg", gray, bytes, {cv::IMWRITE_JPEG_QUALITY, quality})) {
    throw DataError("a frame of " + std::to_string(gray.cols) + " × " + std::to_string(gray.rows) +
                    " pixels cannot be written as JPEG");
  }
  gray = cv::imdecode(bytes, cv::IMREAD_GRAYSCALE);
}

}  // namespace pilotage
