#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

namespace pilotage {

/// Numbers that describe a cell: 18 directions of gradients, 9 without their sign, 4 energies of its surroundings.
inline constexpr int kFhogPlanes = 31;

/// How a filter looks at a picture: a square window slides over cells of gradient histograms (fHOG) of the picture and
/// of smaller copies of it, each 5/6 of the one before.
struct FhogWindow {
  int side_px = 45;  ///< An odd number of cells: of an even one the middle lies half a cell beside the hit.
  int cell_px = 5;
  int levels = 1;  ///< Pictures that are looked at: it and levels − 1 copies.

  /// Cells along a side of the filter: the window's and one around it.
  int filter_cells() const { return side_px / cell_px + 2; }
  /// Numbers of a filter: plane by plane, each row by row, then the threshold.
  std::size_t filter_size() const {
    return static_cast<std::size_t>(kFhogPlanes * filter_cells() * filter_cells()) + 1;
  }
};

/// What is wrong with a window, or "": cells of 4 to 16 px, an odd number of them, 128 px at most, 1 to 32 levels. What
/// a filter costs on a picture is bounded by it.
std::string fhog_window_problem(const FhogWindow& window);

/// A copy of a picture, and what is seen on it, over the next smaller one.
inline constexpr double kFhogPyramidStep = 6.0 / 5.0;

/// Histograms of oriented gradients of a picture's cells (P. Felzenszwalb et al., "Object detection with
/// discriminatively trained part-based models", IEEE Trans. PAMI 32(9), 2010, section 6): as dlib's
/// extract_fhog_features has them, but for rounding (2e-6).
class FhogCells {
 public:
  /// `gray`: CV_8UC1. `margin` cells of zeros lie around those that are described. A cell is described when it has all
  /// its neighbours on the picture; cells are counted from the picture's corner, and half a cell at its end is one.
  FhogCells(const cv::Mat& gray, int cell_px, int margin);

  int rows() const { return rows_; }  ///< Described cells; both 0 for pictures of fewer than three cells.
  int cols() const { return cols_; }
  int margin() const { return margin_; }
  /// Number `plane` of the described cells of a row from column 0 on; margins lie before, behind and in rows −margin …
  /// −1 and rows … rows + margin − 1. Behind the last margin another kFhogTile of zeros may be read.
  const float* row(int plane, int row) const { return values_.data() + offset(plane, row); }

 private:
  std::size_t offset(int plane, int row) const;

  int rows_ = 0;
  int cols_ = 0;
  int margin_ = 0;
  std::size_t stride_ = 0;
  std::vector<float> values_;
};

inline constexpr int kFhogTile = 32;

/// The sum of products of a filter's numbers (FhogWindow::filter_size(), the threshold is not looked at) with the cells
/// around each described cell: CV_32FC1 of cells.rows() × cells.cols(). The margin of the cells is at least half a
/// filter. `checkpoint` is called 31 times, and what it throws comes out.
cv::Mat correlate_fhog(const FhogCells& cells, const std::vector<float>& filter, int filter_cells,
                       const std::function<void()>& checkpoint = {});

/// The next smaller picture: 5/6 of the sides, interpolated linearly with the middles of the corners' pixels on each
/// other, as dlib's pyramid_down<6> makes it.
cv::Mat fhog_pyramid_down(const cv::Mat& gray);

}  // namespace pilotage
