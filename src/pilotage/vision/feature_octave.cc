#include "pilotage/vision/feature_octave.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace pilotage {
namespace {

/// The source pixels that one octave pixel covers along an axis.
struct Cover {
  int first = 0;  ///< Index in the piece.
  std::vector<float> weights;
};

struct Axis {
  std::int64_t first = 0;  ///< In the octave's grid.
  std::vector<Cover> covers;
};

Axis cover_axis(std::int64_t first_pixel, int count, double scale) {
  Axis axis;
  const auto end_pixel = static_cast<double>(first_pixel + count);
  axis.first = static_cast<std::int64_t>(std::ceil(static_cast<double>(first_pixel) / scale));
  for (std::int64_t index = axis.first;; ++index) {
    const double low = static_cast<double>(index) * scale;
    const double high = static_cast<double>(index + 1) * scale;
    if (high > end_pixel) break;
    if (low < static_cast<double>(first_pixel)) {  // rounding of the division
      ++axis.first;
      continue;
    }
    Cover cover;
    const double first = std::floor(low);
    cover.first = static_cast<int>(static_cast<std::int64_t>(first) - first_pixel);
    for (double pixel = first; pixel < high; ++pixel) {
      cover.weights.push_back(static_cast<float>((std::min(high, pixel + 1) - std::max(low, pixel)) / scale));
    }
    axis.covers.push_back(std::move(cover));
  }
  return axis;
}

/// Weighted sums along rows: one float for each octave column.
std::vector<float> sums_of_row(const std::uint8_t* row, const Axis& columns) {
  std::vector<float> sums;
  sums.reserve(columns.covers.size());
  for (const Cover& cover : columns.covers) {
    float sum = 0;
    for (std::size_t i = 0; i < cover.weights.size(); ++i) {
      sum += cover.weights[i] * static_cast<float>(row[static_cast<std::size_t>(cover.first) + i]);
    }
    sums.push_back(sum);
  }
  return sums;
}

cv::Mat average(const cv::Mat& image, const Axis& columns, const Axis& rows) {
  std::vector<std::vector<float>> row_sums;
  for (int row = 0; row < image.rows; ++row) row_sums.push_back(sums_of_row(image.ptr<std::uint8_t>(row), columns));
  cv::Mat result(static_cast<int>(rows.covers.size()), static_cast<int>(columns.covers.size()), CV_8UC1);
  std::vector<float> sums(columns.covers.size());
  for (int row = 0; row < result.rows; ++row) {
    const Cover& cover = rows.covers[static_cast<std::size_t>(row)];
    std::fill(sums.begin(), sums.end(), 0.0F);
    for (std::size_t i = 0; i < cover.weights.size(); ++i) {
      const std::vector<float>& line = row_sums[static_cast<std::size_t>(cover.first) + i];
      for (std::size_t col = 0; col < sums.size(); ++col) sums[col] += cover.weights[i] * line[col];
    }
    auto* const out = result.ptr<std::uint8_t>(row);
    for (std::size_t col = 0; col < sums.size(); ++col) {
      out[col] = static_cast<std::uint8_t>(std::min(255.0F, sums[col] + 0.5F));
    }
  }
  return result;
}

}  // namespace

Octave make_octave(const cv::Mat& gray, const cv::Mat& valid, std::int64_t first_col, std::int64_t first_row,
                   double scale) {
  Octave octave{scale, first_col, first_row, gray, valid};
  if (scale == 1) return octave;
  const Axis columns = cover_axis(first_col, gray.cols, scale);
  const Axis rows = cover_axis(first_row, gray.rows, scale);
  octave.first_col = columns.first;
  octave.first_row = rows.first;
  octave.gray = average(gray, columns, rows);
  if (octave.gray.empty()) {
    octave.valid.release();  // less ground than one pixel of the octave
  } else if (!valid.empty()) {
    // Any invalid pixel under an octave pixel brings its share of the mean below 255.
    octave.valid = average(valid, columns, rows) == 255;
  }
  return octave;
}

}  // namespace pilotage
