#include "pilotage/vision/landmark_detector.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <tuple>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/nan.h"
#include "pilotage/base/text.h"

namespace pilotage {
namespace {

using Eigen::Vector2d;

/// Of a picture, the strongest: a detector that fires everywhere takes neither memory nor time without end.
constexpr std::size_t kMaxPeaks = 20'000;
constexpr std::size_t kPeaksBetweenCheckpoints = 64;
/// Of a window, along a side. A picture of fewer shows nothing.
constexpr int kLeastCells = 3;

/// A cell of one level whose score stands out, on the picture that the filters look at.
struct Peak {
  Vector2d center_px{0, 0};
  double side_px = 0;  ///< Of the window.
  double score = 0;
  std::size_t filter = 0;
};

/// Strongest first; of equals in a fixed order.
bool is_before(const Peak& a, const Peak& b) {
  return std::tuple(-a.score, a.filter, a.side_px, a.center_px.y(), a.center_px.x()) <
         std::tuple(-b.score, b.filter, b.side_px, b.center_px.y(), b.center_px.x());
}

void keep_strongest(std::vector<Peak>& peaks) {
  if (peaks.size() <= kMaxPeaks) return;
  std::nth_element(peaks.begin(), peaks.begin() + kMaxPeaks, peaks.end(), is_before);
  peaks.resize(kMaxPeaks);
}

/// Where between −½ and ½ the parabola through three neighbours is highest.
double between_neighbours(double before, double here, double after) {
  const double bend = before - 2 * here + after;
  return bend < 0 ? std::clamp((before - after) / (2 * bend), -0.5, 0.5) : 0;
}

/// From pixels of a level to those of the picture, corners' middles on each other.
struct LevelScale {
  Vector2d step{1, 1};

  Vector2d picture_px(const Vector2d& level_px) const {
    return (level_px - Vector2d(0.5, 0.5)).cwiseProduct(step) + Vector2d(0.5, 0.5);
  }
};

void append_peaks(const cv::Mat& scores, double threshold, double least_score, const FhogWindow& window,
                  const LevelScale& scale, std::size_t filter, std::vector<Peak>& peaks) {
  const auto score_at = [&](int row, int col) {
    const bool inside = row >= 0 && row < scores.rows && col >= 0 && col < scores.cols;
    return inside ? scores.at<float>(row, col) : -std::numeric_limits<float>::infinity();
  };
  const auto least = static_cast<float>(threshold + least_score);
  for (int row = 0; row < scores.rows; ++row) {
    const float* line = scores.ptr<float>(row);
    for (int col = 0; col < scores.cols; ++col) {
      const float here = line[col];
      if (!(here >= least)) continue;
      bool highest = true;
      for (int step = 0; step < 9 && highest; ++step) {
        // Of equal neighbours the first alone is a peak.
        const float other = score_at(row + step / 3 - 1, col + step % 3 - 1);
        highest = step < 4 ? here > other : step == 4 || here >= other;
      }
      if (!highest) continue;
      Vector2d cell(col + 1.5, row + 1.5);  // its middle; the first cell of the picture is not described
      if (col > 0 && col + 1 < scores.cols) cell.x() += between_neighbours(line[col - 1], here, line[col + 1]);
      if (row > 0 && row + 1 < scores.rows) {
        cell.y() += between_neighbours(score_at(row - 1, col), here, score_at(row + 1, col));
      }
      // The window that was learnt spans the middles of its first and its last cell.
      const double side_px = window.side_px - window.cell_px + 1;
      peaks.push_back({scale.picture_px(window.cell_px * cell), side_px * std::sqrt(scale.step.x() * scale.step.y()),
                       here - threshold, filter});
    }
  }
}

std::vector<Peak> peaks_of(const LandmarkDetector& detector, const cv::Mat& picture, double least_score,
                           const std::function<void()>& checkpoint) {
  const FhogWindow& window = detector.window;
  std::vector<Peak> peaks;
  cv::Mat level = picture;
  LevelScale scale;
  for (int number = 0; number < window.levels; ++number) {
    if (number > 0) {
      const cv::Mat down = fhog_pyramid_down(level);
      if (std::min(down.rows, down.cols) < window.side_px) break;
      scale.step.x() *= static_cast<double>(level.cols - 1) / (down.cols - 1);
      scale.step.y() *= static_cast<double>(level.rows - 1) / (down.rows - 1);
      level = down;
    }
    const FhogCells cells(level, window.cell_px, window.filter_cells() / 2);
    if (cells.rows() == 0) break;
    for (std::size_t filter = 0; filter < detector.filters.size(); ++filter) {
      const std::vector<float>& weights = detector.filters[filter];
      append_peaks(correlate_fhog(cells, weights, window.filter_cells(), checkpoint),
                   static_cast<double>(weights.back()), least_score, window, scale, filter, peaks);
      keep_strongest(peaks);
    }
  }
  std::sort(peaks.begin(), peaks.end(), is_before);
  return peaks;
}

}  // namespace

std::string landmark_detector_problem(const LandmarkDetector& detector) {
  constexpr double kMostWindow_px = 8192;
  constexpr std::size_t kMostFilters = 64;
  const auto outside = [](const char* name, double value, double low, double high) {
    return value >= low && value <= high ? std::string()
                                         : std::string(name) + " = " + format_number(value) + " is outside [" +
                                               format_number(low) + ", " + format_number(high) + "]";
  };
  if (detector.class_name.empty()) return "class is empty";
  for (const std::string& problem :
       {fhog_window_problem(detector.window), outside("gsd_m", detector.gsd_m, 1e-3, 1e3),
        outside("context", detector.context, 1, 10), outside("offset", detector.offset.x(), -1, 1),
        outside("offset", detector.offset.y(), -1, 1), outside("period_deg", detector.period_deg, 0, 360),
        outside("threshold", detector.threshold, -1e6, 1e6), outside("shortest_m", detector.shortest_m, 1e-3, 1e5),
        outside("longest_m", detector.longest_m, detector.shortest_m,
                kMostWindow_px * detector.gsd_m / detector.context)}) {
    if (!problem.empty()) return problem;
  }
  if (const int cells = detector.window.side_px / detector.window.cell_px; cells < kLeastCells) {
    return "the window has " + std::to_string(cells) + " cells along a side, " + std::to_string(kLeastCells) +
           " at least are allowed";
  }
  if (detector.filters.empty() || detector.filters.size() > kMostFilters) {
    return "filters are " + std::to_string(detector.filters.size()) + ", 1 to " + std::to_string(kMostFilters) +
           " are allowed";
  }
  for (const std::vector<float>& filter : detector.filters) {
    if (filter.size() != detector.window.filter_size()) {
      return "a filter has " + std::to_string(filter.size()) + " numbers, the window asks for " +
             std::to_string(detector.window.filter_size());
    }
    const auto odd = std::find_if(filter.begin(), filter.end(), [](float number) { return !std::isfinite(number); });
    if (odd != filter.end()) {
      return "number " + std::to_string(odd - filter.begin()) + " of a filter is not finite";
    }
  }
  return {};
}

std::vector<LandmarkHit> detect_landmarks(const LandmarkDetector& detector, const cv::Mat& gray, double gsd_m,
                                          double least_score, std::size_t most_hits,
                                          const std::function<void()>& checkpoint) {
  const std::string problem = landmark_detector_problem(detector);
  if (!problem.empty()) throw UsageError("detect_landmarks: " + problem);
  if (!(gsd_m > 0 && std::isfinite(gsd_m))) {
    throw UsageError("detect_landmarks: gsd_m = " + format_number(gsd_m) + " is no size of a pixel");
  }
  const double scale = gsd_m / detector.gsd_m;
  std::vector<LandmarkHit> hits;
  if (std::min(gray.cols, gray.rows) * scale < kLeastCells * detector.window.cell_px) return hits;
  cv::Mat seen = gray;
  if (std::abs(scale - 1) > 1e-6) {
    cv::resize(gray, seen, {}, scale, scale, scale < 1 ? cv::INTER_AREA : cv::INTER_CUBIC);
  }
  const Vector2d gray_from_seen(static_cast<double>(gray.cols) / seen.cols, static_cast<double>(gray.rows) / seen.rows);
  std::size_t looked_at = 0;
  for (const Peak& peak : peaks_of(detector, seen, least_score, checkpoint)) {
    if (hits.size() == most_hits) break;
    if (checkpoint && ++looked_at % kPeaksBetweenCheckpoints == 0) checkpoint();
    const double heading_deg =
        static_cast<double>(peak.filter) * detector.period_deg / static_cast<double>(detector.filters.size());
    const LandmarkHit hit{(peak.center_px - peak.side_px * detector.offset).cwiseProduct(gray_from_seen),
                          peak.side_px / detector.context / scale, peak.score,
                          detector.period_deg > 0 ? heading_deg : kNaN};
    const bool again = std::any_of(hits.begin(), hits.end(), [&](const LandmarkHit& stronger) {
      return (hit.center_px - stronger.center_px).norm() < kSamePlace * std::max(hit.length_px, stronger.length_px);
    });
    if (!again) hits.push_back(hit);
  }
  return hits;
}

}  // namespace pilotage
