#include "pilotage/registration/ties.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include <Eigen/Dense>
#include <opencv2/core.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/options.h"
#include "pilotage/base/parallel.h"
#include "pilotage/correlation/correlation_peaks.h"
#include "pilotage/correlation/fft_correlation.h"
#include "pilotage/registration/lit_ground.h"

namespace pilotage {
namespace {

constexpr std::size_t kTiesBetweenReports = 32;  // some milliseconds each
/// Of a square whose dark parts are left out this much must be lit in both dates.
constexpr double kLeastLit = 0.3;

/// A rectangle of one date in memory.
struct Patchwork {
  PixelWindow window;
  cv::Mat pixels;    // CV_32F, less the mean of its ground; 0 where there is none
  cv::Mat valid;     // where there is ground,
  cv::Mat compared;  // and what of it is correlated

  cv::Rect rect(int col, std::int64_t row, int width, int height) const {
    return {static_cast<int>(col - window.col), static_cast<int>(row - window.row), width, height};
  }
};

Patchwork load(const GraySource& source, const PixelWindow& window, bool lit_alone, int template_px) {
  // The mask of all that decides it: so a place's ties do not depend on which others are wanted.
  const int margin = lit_alone ? template_px / 2 + kLitEdge_px + 1 : 0;
  const std::int64_t left = std::max<std::int64_t>(0, window.col - margin);
  const std::int64_t top = std::max<std::int64_t>(0, window.row - margin);
  const std::int64_t right = std::min(source.width_px, window.col + window.width + margin);
  const std::int64_t bottom = std::min(source.height_px, window.row + window.height + margin);
  const Raster raster = source.read({left, top, static_cast<int>(right - left), static_cast<int>(bottom - top)});
  const cv::Rect inside(static_cast<int>(window.col - left), static_cast<int>(window.row - top), window.width,
                        window.height);
  cv::Mat pixels;
  raster.pixels.convertTo(pixels, CV_32F);
  Patchwork patchwork{window, pixels(inside).clone(), raster.valid(inside), raster.valid(inside)};
  if (lit_alone) patchwork.compared = lit_ground(pixels, raster.valid, template_px)(inside);
  patchwork.pixels -= cv::mean(patchwork.pixels, patchwork.valid)[0];
  patchwork.pixels.setTo(0, patchwork.valid == 0);
  return patchwork;
}

/// A square of one date looked for in a larger one of the other.
struct Peak {
  Eigen::Vector2d offset_px;  // from the middle of the search
  double ncc = 0;
  double margin = 0;
};

/// The vertex of the quadratic through the nine values around `at` by least squares, from it; nothing when it is no
/// maximum.
std::optional<Eigen::Vector2d> quadratic_vertex(const cv::Mat& surface, const cv::Point& at) {
  if (at.x < 1 || at.y < 1 || at.x + 1 >= surface.cols || at.y + 1 >= surface.rows) return std::nullopt;
  double x = 0;
  double y = 0;
  double xx = 0;
  double yy = 0;
  double xy = 0;
  for (int dy = -1; dy <= 1; ++dy) {
    for (int dx = -1; dx <= 1; ++dx) {
      const double value = static_cast<double>(surface.at<float>(at.y + dy, at.x + dx));
      x += dx * value / 6;
      y += dy * value / 6;
      xx += (dx == 0 ? -2 : 1) * value / 3;
      yy += (dy == 0 ? -2 : 1) * value / 3;
      xy += dx * dy * value / 4;
    }
  }
  const double determinant = xx * yy - xy * xy;
  if (!(xx < 0 && determinant > 0)) return std::nullopt;  // NaN too
  const Eigen::Vector2d vertex((xy * y - yy * x) / determinant, (xy * x - xx * y) / determinant);
  if (vertex.cwiseAbs().maxCoeff() > 1) return std::nullopt;
  return vertex;
}

std::optional<Peak> find_peak(const Patchwork& from, const cv::Rect& square, const Patchwork& in,
                              const cv::Rect& around, const TieOptions& options, bool lit_alone) {
  double min_overlap = options.min_valid_fraction;
  if (lit_alone) {  // of the square; the correlation asks for a share of what is compared of it
    const double compared = cv::countNonZero(from.compared(square)) / static_cast<double>(square.area());
    if (compared < kLeastLit) return std::nullopt;
    min_overlap = kLeastLit / compared;
  }
  const cv::Mat surface = masked_correlation_surface(from.pixels(square), from.compared(square), in.pixels(around),
                                                     in.compared(around), min_overlap);
  cv::Mat compared = surface.clone();
  cv::patchNaNs(compared, -2);
  cv::Point at;
  double highest = 0;
  cv::minMaxLoc(compared, nullptr, &highest, nullptr, &at);
  if (highest < options.min_ncc) return std::nullopt;
  const auto vertex = quadratic_vertex(surface, at);
  if (!vertex) return std::nullopt;
  const CorrelationPeaks peaks = correlation_peaks(surface, at, square.width);
  const double margin = std::isnan(peaks.margin) ? highest : peaks.margin;
  if (margin < options.min_margin) return std::nullopt;
  const Eigen::Vector2d middle((surface.cols - 1) / 2.0, (surface.rows - 1) / 2.0);
  return Peak{Eigen::Vector2d(at.x, at.y) + *vertex - middle, highest, margin};
}

struct TieRequest {
  const GraySource& reference;
  const GraySource& second;
  int radius_px;
  const TieOptions& options;
  const Wanted& wanted;
  int threads;

  bool lit_alone() const { return leaves_shadows_out(options, reference.map_from_pixel.x_per_col); }
  /// Room that a place needs around its square: the search, and the search backwards from its end.
  int halo_px() const { return 2 * radius_px; }
  Bounds bounds(std::int64_t col, std::int64_t row) const {
    const double side = options.template_px;
    Bounds box;
    for (const double x : {0.0, side}) {
      box.extend(reference.map_from_pixel.map_from_pixel({static_cast<double>(col) + x, static_cast<double>(row) + x}));
    }
    return box;
  }
};

/// One place of a row, or nothing.
std::optional<Tie> find_tie(const TieRequest& request, const Patchwork& reference, const Patchwork& second, int col,
                            std::int64_t row) {
  const int side = request.options.template_px;
  const int search = side + 2 * request.radius_px;
  const auto inside = [&](const cv::Rect& rect) {
    return (rect & cv::Rect(0, 0, reference.pixels.cols, reference.pixels.rows)) == rect;
  };
  const cv::Rect square = reference.rect(col, row, side, side);
  const cv::Rect around(square.x - request.radius_px, square.y - request.radius_px, search, search);
  if (!inside(around)) return std::nullopt;
  const auto peak = find_peak(reference, square, second, around, request.options, request.lit_alone());
  if (!peak) return std::nullopt;
  const cv::Point step(static_cast<int>(std::lround(peak->offset_px.x())),
                       static_cast<int>(std::lround(peak->offset_px.y())));
  const cv::Rect found = square + step;
  const cv::Rect back = around + step;
  if (!inside(back)) return std::nullopt;
  const auto backwards = find_peak(second, found, reference, back, request.options, request.lit_alone());
  if (!backwards) return std::nullopt;
  const Eigen::Vector2d miss = backwards->offset_px + Eigen::Vector2d(step.x, step.y);
  if (miss.norm() > request.options.max_backward_px) return std::nullopt;
  const GeoTransform& place = request.reference.map_from_pixel;
  Tie tie;
  tie.point_m = place.map_from_pixel({col + side / 2.0, static_cast<double>(row) + side / 2.0});
  tie.displacement_m = {peak->offset_px.x() * place.x_per_col, peak->offset_px.y() * place.y_per_row};
  tie.gsd_m = place.x_per_col;
  tie.ncc = peak->ncc;
  tie.margin = peak->margin;
  return tie;
}

/// Places of one row whose square is wanted and has ground in both dates.
std::vector<int> places_of(const TieRequest& request, const Patchwork& reference, const Patchwork& second,
                           const std::vector<int>& columns, std::int64_t row) {
  const int side = request.options.template_px;
  const double least = request.options.min_valid_fraction * side * side;
  std::vector<int> places;
  for (const int col : columns) {
    const cv::Rect square = reference.rect(col, row, side, side);
    if (cv::countNonZero(reference.valid(square)) < least || cv::countNonZero(second.valid(square)) < least) continue;
    places.push_back(col);
  }
  return places;
}

void check(const GraySource& reference, const GraySource& second, int radius_px, const TieOptions& options) {
  check_options(options);
  const GeoTransform& place = reference.map_from_pixel;
  if (!(place == second.map_from_pixel) || reference.width_px != second.width_px ||
      reference.height_px != second.height_px) {
    throw UsageError("find_ties: both dates must be on one grid");
  }
  const bool square_pixels =
      place.x_per_col > 0 && std::abs(place.y_per_row + place.x_per_col) < 1e-9 * place.x_per_col;
  if (!square_pixels || place.x_per_row != 0 || place.y_per_col != 0) {
    throw UsageError("find_ties: the grid is not north-up with square pixels");
  }
  if (radius_px < 2 || radius_px > 1024) {
    throw UsageError("find_ties: radius_px = " + std::to_string(radius_px) + " is outside [2, 1024]");
  }
}

std::vector<int> wanted_columns(const TieRequest& request, std::int64_t row) {
  std::vector<int> columns;
  for (int col = request.radius_px; col + request.options.template_px + request.radius_px <= request.reference.width_px;
       col += request.options.spacing_px) {
    if (!request.wanted || request.wanted(request.bounds(col, row))) columns.push_back(col);
  }
  return columns;
}

/// The strip of both dates that the places of a row need.
PixelWindow strip_window(const TieRequest& request, const std::vector<int>& columns, std::int64_t row) {
  const int halo = request.halo_px();
  const int side = request.options.template_px;
  const std::int64_t left = std::max(0, columns.front() - halo);
  const std::int64_t top = std::max<std::int64_t>(0, row - halo);
  const std::int64_t right = std::min<std::int64_t>(request.reference.width_px, columns.back() + side + halo);
  const std::int64_t bottom = std::min<std::int64_t>(request.reference.height_px, row + side + halo);
  return {left, top, static_cast<int>(right - left), static_cast<int>(bottom - top)};
}

}  // namespace

TieSearch find_ties(const GraySource& reference, const GraySource& second, int radius_px, const TieOptions& options,
                    const Wanted& wanted, int threads, const Progress& progress) {
  check(reference, second, radius_px, options);
  const TieRequest request{reference, second, radius_px, options, wanted, threads};
  TieSearch search;
  for (std::int64_t row = radius_px; row + options.template_px + radius_px <= reference.height_px;
       row += options.spacing_px) {
    report_progress(progress, "register", row, reference.height_px);
    const std::vector<int> columns = wanted_columns(request, row);
    if (columns.empty()) continue;
    const PixelWindow window = strip_window(request, columns, row);
    std::vector<Patchwork> dates(2);
    parallel_for(2, threads, [&](std::size_t i, int) {
      dates[i] = load(i == 0 ? reference : second, window, request.lit_alone(), options.template_px);
    });
    const std::vector<int> places = places_of(request, dates[0], dates[1], columns, row);
    std::vector<std::optional<Tie>> found(places.size());
    for (std::size_t first = 0; first < places.size(); first += kTiesBetweenReports) {
      report_progress(progress, "register", row, reference.height_px);
      parallel_for(std::min(kTiesBetweenReports, places.size() - first), threads, [&](std::size_t i, int) {
        found[first + i] = find_tie(request, dates[0], dates[1], places[first + i], row);
      });
    }
    search.places += static_cast<std::int64_t>(places.size());
    for (const auto& tie : found) {
      if (tie) search.ties.push_back(*tie);
    }
  }
  report_progress(progress, "register", reference.height_px, reference.height_px);
  return search;
}

}  // namespace pilotage
