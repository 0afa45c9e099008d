#include "pilotage/vision/fhog.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string>

#include <opencv2/core.hpp>
#include <opencv2/core/hal/intrin.hpp>

#include "pilotage/base/error.h"

namespace pilotage {
namespace {

constexpr int kSigned = 18;
constexpr int kUnsigned = 9;
/// Of a histogram's number when it is normalised, and of the sum of four such.
constexpr float kClip = 0.2F;
constexpr float kFourWays = 0.5F;
/// Of the sum of 18 clipped numbers: about 1/√18, as published.
constexpr float kTextureScale = 0.2357F;
constexpr float kLeastEnergy = 1e-4F;
constexpr int kLargestStep = 255;
constexpr int kSteps = 2 * kLargestStep + 1;

/// The direction of a gradient of whole gray values among 18, 20° apart: the nearest, of equals the first. Its axes are
/// given to four digits where filters are trained, and a gradient beside the border of two directions must fall on the
/// same side here.
class DirectionTable {
 public:
  DirectionTable() : nearest_(static_cast<std::size_t>(kSteps) * kSteps) {
    constexpr std::array<std::array<float, 2>, kUnsigned> kAxes{{{1.0000F, 0.0000F},
                                                                 {0.9397F, 0.3420F},
                                                                 {0.7660F, 0.6428F},
                                                                 {0.5000F, 0.8660F},
                                                                 {0.1736F, 0.9848F},
                                                                 {-0.1736F, 0.9848F},
                                                                 {-0.5000F, 0.8660F},
                                                                 {-0.7660F, 0.6428F},
                                                                 {-0.9397F, 0.3420F}}};
    for (int dy = -kLargestStep; dy <= kLargestStep; ++dy) {
      for (int dx = -kLargestStep; dx <= kLargestStep; ++dx) {
        float best = 0;
        int nearest = 0;
        for (int axis = 0; axis < kUnsigned; ++axis) {
          const auto& [x, y] = kAxes[static_cast<std::size_t>(axis)];
          const float along = static_cast<float>(dx) * x + static_cast<float>(dy) * y;
          if (std::abs(along) <= best) continue;
          best = std::abs(along);
          nearest = along > 0 ? axis : axis + kUnsigned;
        }
        nearest_[index(dx, dy)] = static_cast<std::uint8_t>(nearest);
      }
    }
  }

  int nearest(int dx, int dy) const { return nearest_[index(dx, dy)]; }

 private:
  static std::size_t index(int dx, int dy) {
    return static_cast<std::size_t>(dy + kLargestStep) * kSteps + static_cast<std::size_t>(dx + kLargestStep);
  }

  std::vector<std::uint8_t> nearest_;
};

const DirectionTable& directions() {
  static const DirectionTable table;
  return table;
}

/// Between which two cells a pixel lies, and how near to the second.
struct BetweenCells {
  int first = 0;  ///< Counted from one cell outside of the picture.
  float second = 0;
};

BetweenCells between_cells(int pixel, int cell_px) {
  const float place = (static_cast<float>(pixel) + 0.5F) / static_cast<float>(cell_px) + 0.5F;
  const int first = static_cast<int>(place);
  return {first, place - static_cast<float>(first)};
}

/// Histograms of a picture's cells, one plane for each direction, with a cell around them; rows are padded so that four
/// may be read at any cell.
struct Histograms {
  int rows = 0;
  int cols = 0;
  std::size_t stride = 0;
  std::vector<float> planes;

  float* row(int direction, int row) {
    return planes.data() + (static_cast<std::size_t>(direction) * static_cast<std::size_t>(rows + 2) +
                            static_cast<std::size_t>(row + 1)) *
                               stride;
  }
};

int cells_along(int pixels, int cell_px) {
  return static_cast<int>(std::floor(static_cast<float>(pixels) / static_cast<float>(cell_px) + 0.5F));
}

Histograms histograms_of(const cv::Mat& gray, int cell_px) {
  Histograms all;
  all.rows = cells_along(gray.rows, cell_px);
  all.cols = cells_along(gray.cols, cell_px);
  const int cells = all.cols + 2;
  all.stride = static_cast<std::size_t>(cells) + 8;
  all.planes.assign(kSigned * static_cast<std::size_t>(all.rows + 2) * all.stride, 0);
  // Pixels at the border have no gradient.
  const int end_x = std::min(all.cols * cell_px, gray.cols) - 1;
  const int end_y = std::min(all.rows * cell_px, gray.rows) - 1;
  std::vector<BetweenCells> between;
  for (int x = 0; x < end_x; ++x) between.push_back(between_cells(x, cell_px));
  // A row of pixels is summed first and then divided between two rows of cells.
  std::vector<float> of_row(static_cast<std::size_t>(cells) * kSigned);
  const DirectionTable& table = directions();
  for (int y = 1; y < end_y; ++y) {
    const std::uint8_t* above = gray.ptr<std::uint8_t>(y - 1);
    const std::uint8_t* here = gray.ptr<std::uint8_t>(y);
    const std::uint8_t* below = gray.ptr<std::uint8_t>(y + 1);
    std::fill(of_row.begin(), of_row.end(), 0.0F);
    for (int x = 1; x < end_x; ++x) {
      const int dx = here[x + 1] - here[x - 1];
      const int dy = below[x] - above[x];
      const float length = std::sqrt(static_cast<float>(dx * dx + dy * dy));
      const BetweenCells& cell = between[static_cast<std::size_t>(x)];
      float* bin = of_row.data() + static_cast<std::size_t>(cell.first) * kSigned + table.nearest(dx, dy);
      bin[0] += (1 - cell.second) * length;
      bin[kSigned] += cell.second * length;
    }
    const BetweenCells rows = between_cells(y, cell_px);
    for (int direction = 0; direction < kSigned; ++direction) {
      float* first = all.row(direction, rows.first - 1);
      float* second = first + all.stride;
      const float* from = of_row.data() + direction;
      for (int cell = 0; cell < cells; ++cell) {
        const float value = from[static_cast<std::size_t>(cell) * kSigned];
        first[cell] += (1 - rows.second) * value;
        second[cell] += rows.second * value;
      }
    }
  }
  return all;
}

using Four = cv::v_float32x4;

Four four(float value) {
  return cv::v_setall_f32(value);
}

}  // namespace

std::string fhog_window_problem(const FhogWindow& window) {
  const auto outside = [](const char* name, int value, int low, int high) {
    return value < low || value > high ? std::string(name) + " = " + std::to_string(value) + " is outside [" +
                                             std::to_string(low) + ", " + std::to_string(high) + "]"
                                       : std::string();
  };
  for (const std::string& problem :
       {outside("cell_px", window.cell_px, 4, 16), outside("window_px", window.side_px, window.cell_px, 128),
        outside("levels", window.levels, 1, 32)}) {
    if (!problem.empty()) return problem;
  }
  if (window.side_px % window.cell_px == 0 && window.side_px / window.cell_px % 2 == 1) return {};
  return "window_px = " + std::to_string(window.side_px) +
         " is no odd multiple of cell_px = " + std::to_string(window.cell_px);
}

std::size_t FhogCells::offset(int plane, int row) const {
  const auto padded_rows = static_cast<std::size_t>(rows_ + 2 * margin_);
  return (static_cast<std::size_t>(plane) * padded_rows + static_cast<std::size_t>(row + margin_)) * stride_ +
         static_cast<std::size_t>(margin_);
}

FhogCells::FhogCells(const cv::Mat& gray, int cell_px, int margin) : margin_(margin) {
  if (gray.type() != CV_8UC1 || cell_px < 2 || margin < 0) throw UsageError("FhogCells: bad picture, cell or margin");
  Histograms histograms = histograms_of(gray, cell_px);
  rows_ = std::max(histograms.rows - 2, 0);
  cols_ = std::max(histograms.cols - 2, 0);
  if (rows_ == 0 || cols_ == 0) {
    rows_ = cols_ = 0;
    return;
  }
  stride_ = static_cast<std::size_t>(cols_ + 2 * margin_ + kFhogTile);
  values_.assign(kFhogPlanes * static_cast<std::size_t>(rows_ + 2 * margin_) * stride_, 0);

  // Energies of cells, of all their directions without sign.
  const auto cells = static_cast<std::size_t>(histograms.cols);
  const std::size_t stride = cells + 8;
  std::vector<float> energy(static_cast<std::size_t>(histograms.rows) * stride, 0);
  for (int row = 0; row < histograms.rows; ++row) {
    float* sum = energy.data() + static_cast<std::size_t>(row) * stride;
    for (int direction = 0; direction < kUnsigned; ++direction) {
      const float* one = histograms.row(direction, row) + 1;
      const float* other = histograms.row(direction + kUnsigned, row) + 1;
      for (std::size_t col = 0; col < cells; ++col) sum[col] += (one[col] + other[col]) * (one[col] + other[col]);
    }
  }

  // Each cell is normalised by the energies of the four squares of cells that it is a corner of. Four columns at a
  // time; what is written behind the last column is made zero again.
  const Four least = four(kLeastEnergy);
  for (int row = 0; row < rows_; ++row) {
    for (int col = 0; col < cols_; col += 4) {
      std::array<Four, 4> limit;
      std::array<Four, 4> factor;
      std::array<Four, 4> texture;
      for (std::size_t corner = 0; corner < 4; ++corner) {
        const auto corner_row = static_cast<std::size_t>(row) + corner / 2;
        const auto corner_col = static_cast<std::size_t>(col) + corner % 2;
        const float* first = energy.data() + corner_row * stride + corner_col;
        const Four sum = cv::v_load(first) + cv::v_load(first + 1) + cv::v_load(first + stride) +
                         cv::v_load(first + stride + 1) + least;
        limit[corner] = four(kClip) * cv::v_sqrt(sum);
        factor[corner] = four(kClip * kFourWays) / limit[corner];
        texture[corner] = four(0);
      }
      const auto clipped = [&](const Four& value, std::size_t corner) {
        return cv::v_min(value, limit[corner]) * factor[corner];
      };
      const auto write = [&](int plane, const Four& value) {
        cv::v_store(values_.data() + offset(plane, row) + col, value);
      };
      for (int direction = 0; direction < kSigned; ++direction) {
        const Four value = cv::v_load(histograms.row(direction, row + 1) + col + 2);
        Four sum = four(0);
        for (std::size_t corner = 0; corner < 4; ++corner) {
          const Four part = clipped(value, corner);
          sum += part;
          texture[corner] += part;
        }
        write(direction, sum);
      }
      for (int direction = 0; direction < kUnsigned; ++direction) {
        const Four value = cv::v_load(histograms.row(direction, row + 1) + col + 2) +
                           cv::v_load(histograms.row(direction + kUnsigned, row + 1) + col + 2);
        Four sum = four(0);
        for (std::size_t corner = 0; corner < 4; ++corner) sum += clipped(value, corner);
        write(kSigned + direction, sum);
      }
      // dlib's order: the squares up left, up right … are its last three, and its first is down right.
      constexpr std::array<int, 4> kOrder{3, 1, 2, 0};
      for (std::size_t corner = 0; corner < 4; ++corner) {
        write(kSigned + kUnsigned + kOrder[corner], texture[corner] * four(2 * kTextureScale));
      }
    }
    for (int plane = 0; plane < kFhogPlanes; ++plane) {
      float* end = values_.data() + offset(plane, row) + cols_;
      std::fill(end, end + 4, 0.0F);
    }
  }
}

cv::Mat correlate_fhog(const FhogCells& cells, const std::vector<float>& filter, int filter_cells,
                       const std::function<void()>& checkpoint) {
  const int reach = filter_cells / 2;
  if (filter_cells < 1 || filter_cells % 2 == 0 || cells.margin() < reach ||
      std::ssize(filter) < std::ptrdiff_t{kFhogPlanes} * filter_cells * filter_cells) {
    throw UsageError("correlate_fhog: a filter of " + std::to_string(filter_cells) + " cells and " +
                     std::to_string(filter.size()) + " numbers on cells with a margin of " +
                     std::to_string(cells.margin()));
  }
  if (cells.rows() == 0) return {};
  constexpr int kRegisters = kFhogTile / 4;
  const int padded = (cells.cols() + kFhogTile - 1) / kFhogTile * kFhogTile;
  cv::Mat sums(cells.rows(), padded, CV_32FC1, cv::Scalar(0));
  const float* weights = filter.data();
  for (int plane = 0; plane < kFhogPlanes; ++plane, weights += filter_cells * filter_cells) {
    if (checkpoint) checkpoint();
    for (int row = 0; row < cells.rows(); ++row) {
      for (int col = 0; col < padded; col += kFhogTile) {
        float* at = sums.ptr<float>(row) + col;
        Four s0 = cv::v_load(at);
        Four s1 = cv::v_load(at + 4);
        Four s2 = cv::v_load(at + 8);
        Four s3 = cv::v_load(at + 12);
        Four s4 = cv::v_load(at + 16);
        Four s5 = cv::v_load(at + 20);
        Four s6 = cv::v_load(at + 24);
        Four s7 = cv::v_load(at + 28);
        static_assert(kRegisters == 8);
        const float* weight = weights;
        for (int i = -reach; i <= reach; ++i) {
          const float* from = cells.row(plane, row + i) + col - reach;
          for (int j = 0; j < filter_cells; ++j, ++from, ++weight) {
            const Four w = four(*weight);
            s0 = cv::v_muladd(cv::v_load(from), w, s0);
            s1 = cv::v_muladd(cv::v_load(from + 4), w, s1);
            s2 = cv::v_muladd(cv::v_load(from + 8), w, s2);
            s3 = cv::v_muladd(cv::v_load(from + 12), w, s3);
            s4 = cv::v_muladd(cv::v_load(from + 16), w, s4);
            s5 = cv::v_muladd(cv::v_load(from + 20), w, s5);
            s6 = cv::v_muladd(cv::v_load(from + 24), w, s6);
            s7 = cv::v_muladd(cv::v_load(from + 28), w, s7);
          }
        }
        cv::v_store(at, s0);
        cv::v_store(at + 4, s1);
        cv::v_store(at + 8, s2);
        cv::v_store(at + 12, s3);
        cv::v_store(at + 16, s4);
        cv::v_store(at + 20, s5);
        cv::v_store(at + 24, s6);
        cv::v_store(at + 28, s7);
      }
    }
  }
  return sums.colRange(0, cells.cols());
}

cv::Mat fhog_pyramid_down(const cv::Mat& gray) {
  const int rows = 5 * gray.rows / 6;
  const int cols = 5 * gray.cols / 6;
  cv::Mat down(rows, cols, CV_8UC1);
  const double step_x = static_cast<double>(gray.cols - 1) / std::max(cols - 1, 1);
  const double step_y = static_cast<double>(gray.rows - 1) / std::max(rows - 1, 1);
  struct Between {
    int left = 0;
    int right = 0;
    float share = 0;
  };
  // Places and sums in the order in which dlib rounds them: halves of gray values go up in one and down in another.
  std::vector<Between> between;
  std::array<float, 4> lanes{};
  for (std::size_t lane = 0; lane < 4; ++lane) {
    lanes[lane] = static_cast<float>(-4 * step_x + static_cast<double>(lane) * step_x);
  }
  for (int x = 0; x < cols; ++x) {
    float& at = lanes[static_cast<std::size_t>(x % 4)];
    at += static_cast<float>(4 * step_x);
    const int left = std::clamp(static_cast<int>(at), 0, gray.cols - 1);
    between.push_back({left, std::min(left + 1, gray.cols - 1), at - static_cast<float>(left)});
  }
  double y_at = -step_y;
  for (int y = 0; y < rows; ++y) {
    y_at += step_y;
    const int top = std::min(static_cast<int>(y_at), gray.rows - 1);
    const auto lower_share = static_cast<float>(y_at - top);
    const auto upper_share = static_cast<float>(1 - (y_at - top));
    const std::uint8_t* upper = gray.ptr<std::uint8_t>(top);
    const std::uint8_t* lower = gray.ptr<std::uint8_t>(std::min(top + 1, gray.rows - 1));
    std::uint8_t* to = down.ptr<std::uint8_t>(y);
    for (int x = 0; x < cols; ++x) {
      const auto& [left, right, share] = between[static_cast<std::size_t>(x)];
      const float rest = 1 - share;
      const float value_and_half = upper_share * rest * static_cast<float>(upper[left]) +
                                   upper_share * share * static_cast<float>(upper[right]) +
                                   lower_share * rest * static_cast<float>(lower[left]) +
                                   lower_share * share * static_cast<float>(lower[right]) + 0.5F;
      to[x] = static_cast<std::uint8_t>(value_and_half);
    }
  }
  return down;
}

}  // namespace pilotage
