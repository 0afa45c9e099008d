#include "pilotage/match/chip_correlation.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include <opencv2/core.hpp>

#include "pilotage/vision/direction_field.h"

namespace pilotage {
namespace {

constexpr double kOne = 127;            // of a field in 8 bits
constexpr double kEvenVariance = 1e-3;  // of directions, whose length is at most 1
constexpr double kNotCompared = -2;

/// What sums over pixels are made of, in 8 bits with a sign: a field, its squared length, where it is valid, and that
/// as the one and the other channel of a field.
struct Summands {
  cv::Mat z;        // CV_8SC2
  cv::Mat squares;  // CV_8SC1
  cv::Mat valid;    // CV_8SC1, 0 or 1
  cv::Mat valid_x;  // CV_8SC2
  cv::Mat valid_y;
};

Summands summands_of(const cv::Mat& z, const cv::Mat& valid) {
  Summands result;
  cv::Mat channels[2];
  cv::split(z, channels);
  cv::Mat squares = channels[0].mul(channels[0]) + channels[1].mul(channels[1]);
  const cv::Mat holes = valid == 0;
  squares.setTo(0, holes);
  squares.convertTo(result.squares, CV_8S, kOne);
  z.convertTo(result.z, CV_8S, kOne);
  result.z.setTo(0, holes);
  valid.convertTo(result.valid, CV_8S, 1.0 / 255);
  const cv::Mat none = cv::Mat::zeros(valid.size(), CV_8SC1);
  cv::merge(std::vector<cv::Mat>{result.valid, none}, result.valid_x);
  cv::merge(std::vector<cv::Mat>{none, result.valid}, result.valid_y);
  return result;
}

Summands part_of(const Summands& whole, const cv::Rect& rect) {
  return {whole.z(rect), whole.squares(rect), whole.valid(rect), whole.valid_x(rect), whole.valid_y(rect)};
}

struct Compared {
  double ncc = kNotCompared;
  int pixels = 0;
};

Compared compare(const Summands& t, const Summands& g, double needed_px) {
  const double n = t.valid.dot(g.valid);
  if (n < std::max(2.0, needed_px)) return {};
  const Eigen::Vector2d t_sum = Eigen::Vector2d(t.z.dot(g.valid_x), t.z.dot(g.valid_y)) / kOne;
  const Eigen::Vector2d g_sum = Eigen::Vector2d(g.z.dot(t.valid_x), g.z.dot(t.valid_y)) / kOne;
  const double t_scatter = t.squares.dot(g.valid) / kOne - t_sum.squaredNorm() / n;
  const double g_scatter = g.squares.dot(t.valid) / kOne - g_sum.squaredNorm() / n;
  if (std::min(t_scatter, g_scatter) <= kEvenVariance * n) return {0, static_cast<int>(n)};
  const double product = t.z.dot(g.z) / (kOne * kOne) - t_sum.dot(g_sum) / n;
  return {std::clamp(product / std::sqrt(t_scatter * g_scatter), -1.0, 1.0), static_cast<int>(n)};
}

/// Position of the vertex of the parabola through three values, from the middle one; 0 when it is not a maximum.
double vertex(double before, double at, double after) {
  const double curvature = before - 2 * at + after;
  return curvature < 0 ? std::clamp(0.5 * (before - after) / curvature, -0.5, 0.5) : 0;
}

/// The correlation about a position, each of its values computed once.
class Neighbourhood {
 public:
  Neighbourhood(const ChipTemplates& templates, std::size_t index, const ChipMosaic& mosaic, const cv::Point& start,
                int reach_px, double needed_px)
      : template_(summands_of(templates.z[index], templates.mask)), needed_px_(needed_px) {
    const int margin = reach_px + 1;
    const cv::Rect rect(start.x + templates.canvas.left - margin, start.y + templates.canvas.top - margin,
                        templates.canvas.width + 2 * margin, templates.canvas.height + 2 * margin);
    const ChipRegion region = cut_chip_region(mosaic, rect);
    region_ = summands_of(region.z, region.valid);
    first_ = {start.x - margin, start.y - margin};
    size_ = templates.mask.size();
  }

  const Compared& at(const cv::Point& position) {
    const auto key = std::pair(position.x, position.y);
    const auto known = known_.find(key);
    if (known != known_.end()) return known->second;
    return known_[key] = compare(template_, part_of(region_, {position - first_, size_}), needed_px_);
  }

 private:
  Summands template_;
  Summands region_;
  cv::Point first_;
  cv::Size size_;
  double needed_px_ = 0;
  std::map<std::pair<int, int>, Compared> known_;
};

cv::Point highest_neighbour(Neighbourhood& about, const cv::Point& at) {
  cv::Point best = at;
  for (int dy = -1; dy <= 1; ++dy) {
    for (int dx = -1; dx <= 1; ++dx) {
      const cv::Point next(at.x + dx, at.y + dy);
      if (about.at(next).ncc > about.at(best).ncc) best = next;
    }
  }
  return best;
}

}  // namespace

ChipRegion cut_chip_region(const ChipMosaic& mosaic, const cv::Rect& rect) {
  ChipRegion region{cv::Mat::zeros(rect.size(), CV_32FC2), cv::Mat::zeros(rect.size(), CV_8UC1)};
  const cv::Rect inside = rect & cv::Rect({0, 0}, mosaic.steps.size());
  if (inside.empty()) return region;
  field_from_steps(mosaic.steps(inside)).copyTo(region.z(inside - rect.tl()));
  mosaic.valid(inside).copyTo(region.valid(inside - rect.tl()));
  return region;
}

ChipPeak climb(const ChipTemplates& templates, std::size_t index, const ChipMosaic& mosaic, const cv::Point& start,
               int reach_px, double needed_px) {
  Neighbourhood about(templates, index, mosaic, start, reach_px, needed_px);
  cv::Point at = start;
  for (;;) {
    const cv::Point next = highest_neighbour(about, at);
    if (next == at || std::max(std::abs(next.x - start.x), std::abs(next.y - start.y)) > reach_px) break;
    at = next;
  }
  const Compared& peak = about.at(at);
  const auto offset = [&](const cv::Point& step) {
    const double before = about.at(at - step).ncc;
    const double after = about.at(at + step).ncc;
    return std::min(before, after) > kNotCompared ? vertex(before, peak.ncc, after) : 0;
  };
  ChipPeak result;
  if (peak.ncc <= kNotCompared) return result;
  result.at_px = {at.x + offset({1, 0}), at.y + offset({0, 1})};
  result.ncc = peak.ncc;
  result.pixels = peak.pixels;
  return result;
}

}  // namespace pilotage
