#pragma once

#include <functional>
#include <optional>
#include <vector>

#include <opencv2/core/mat.hpp>

namespace pilotage {

/// What a correlation surface says about its main peak. NaN where a number is not defined.
struct CorrelationPeaks {
  double peak = 0;           ///< R1: the surface at the true position.
  double rival = 0;          ///< R2: highest value outside the main lobe; NaN when nothing lies outside it.
  double margin = 0;         ///< R1 − R2.
  double rival_ratio = 0;    ///< R2 / R1; NaN when R1 ≤ 0.
  double psr = 0;            ///< (R1 − mean) / σ of the surface outside the main lobe (σ with N); NaN when σ = 0.
  double rivals = 0;         ///< Local maxima of at least 0.8 R1 outside the main lobe; NaN when R1 ≤ 0.
  double half_width_px = 0;  ///< sqrt(area/π) of the connected region around R1 that exceeds R1/2; NaN when R1 ≤ 0.
  double expected_error_px = 0;  ///< σ of the fix per axis; NaN when the peak has no maximum in both directions.
  double rival_dx_px = 0;        ///< Position of R2 minus the true position, columns to the right.
  double rival_dy_px = 0;        ///< Rows down.
};

/// Reads the peaks of `surface` (CV_32F; NaN = position excluded) around the true position `truth` (column, row), which
/// must lie inside it, in one pass over the surface. `tile_size_px` is the side of the template.
///
/// Main lobe: the square of half side m around the true position, m = min(2·reach, max(2, tile_size_px/16)), at least
/// 2, where reach is how far (in columns or rows) the 4-connected region above R1/2 extends, itself looked for within
/// tile_size_px/16. So a sharp peak hides little of its surroundings, and ground that is smooth over more than a
/// sixteenth of the tile has its own shoulder as rival. A local maximum exceeds its left and upper neighbours, and its
/// right and lower ones or equals them.
///
/// Expected error: with C the matrix of second differences of −R at the peak and ρ = min(R1, 0.9) (a second picture of
/// the ground is never the same: the clean R1 = 1 would promise 0 px),
///   σ² = (1 − ρ²) / (ρ·n) · trace(C⁻¹)/2,   n = N / lobe area independent samples of N = tile_size_px² pixels,
/// the Cramér-Rao bound of a shift between two noisy pictures (D. Robinson, P. Milanfar, "Fundamental performance
/// limits in image registration", IEEE Trans. Image Processing 13(9), 2004, eq. 9–11) with the signal-to-noise ratio
/// that R1 implies and noise as correlated as the ground itself (docs/methods/uniqueness.md). Throws UsageError when
/// the surface is not CV_32F or `truth` lies outside it.
CorrelationPeaks correlation_peaks(const cv::Mat& surface, const cv::Point& truth, int tile_size_px);

/// A surface of which a part is known: a lattice of positions, and all around the true one.
struct SparseSurface {
  cv::Mat lattice;          ///< CV_32F: the positions a multiple of `step` columns and rows from the true one.
  cv::Point lattice_truth;  ///< The true position in `lattice`.
  int step = 2;
  cv::Mat near;          ///< CV_32F: all positions up to near_radius_px() columns and rows from the true one.
  cv::Point near_truth;  ///< The true position in `near`.
};

/// Radius of `near` for tiles of this side: the largest main lobe and one position more, made odd.
int near_radius_px(int tile_size_px);

struct SurfaceValue {
  cv::Point lag;  ///< From the true position.
  float value = 0;
};
/// Values at a lag and its up to eight neighbours.
using ValuesAround = std::function<std::vector<SurfaceValue>(const cv::Point& lag)>;

/// The peaks from a part of the surface: what belongs to the main lobe, and rivals next to it, exactly; the highest
/// rival elsewhere by climbing, with `values_around`, from each local maximum of the lattice that may hide a higher one
/// than is known. It may if its height by parabolas through its neighbours, plus 0.5·fall·height, exceeds the best
/// value so far, where fall is how much the main peak falls over half a step in columns and rows. Rivals are counted by
/// those heights, and mean and σ are taken from the lattice with the weight of step² positions. Nothing when the fall
/// exceeds 0.5: then a peak fits between the known positions. How much this differs from correlation_peaks() of all
/// positions stands in docs/methods/uniqueness.md. Throws UsageError as correlation_peaks().
std::optional<CorrelationPeaks> sparse_correlation_peaks(const SparseSurface& surface, int tile_size_px,
                                                         const ValuesAround& values_around);

}  // namespace pilotage
