#include "pilotage/capture/contradictions.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "pilotage/base/error.h"
#include "pilotage/base/statistics.h"
#include "pilotage/base/text.h"

namespace pilotage {
namespace {

constexpr double kContradiction = 5;  // standard deviations
constexpr double kLargestTurn_deg = 30;
/// Points that a frame has to have in common with others to be one of the block after its adjustment.
constexpr int kFewestShared = 10;

}  // namespace

Contradictions find_contradictions(const CaptureFrames& frames, const Block& block, const BlockStart& start,
                                   const AdjustedBlock& adjusted) {
  std::vector<double> across_m;
  std::vector<double> up_m;
  for (const Eigen::Vector3d& residual : adjusted.position_residuals_m) {
    across_m.push_back(residual.head<2>().norm());
    up_m.push_back(std::abs(residual.z()));
  }
  const double usual_across_m = quantile(across_m, 0.5);
  const double usual_up_m = quantile(up_m, 0.5);
  const double usual_turn_deg = quantile(start.turned_deg, 0.5);
  Contradictions found;
  for (std::size_t i = 0; i < across_m.size(); ++i) {
    const std::string& path = frames.frames[i].path;
    const double limit_m = kContradiction * std::max(block.measured[i].sigma_en_m, usual_across_m);
    const double up_limit_m = kContradiction * std::max(block.measured[i].sigma_up_m, usual_up_m);
    found.position.push_back(across_m[i] > limit_m || up_m[i] > up_limit_m);
    if (across_m[i] > limit_m) {
      found.problems.push_back(path + ": its position lies " + format_fixed(across_m[i], 1) +
                               " m from where the pictures put it (at most " + format_fixed(limit_m, 1) + " m)");
    } else if (up_m[i] > up_limit_m) {
      found.problems.push_back(path + ": its height lies " + format_fixed(up_m[i], 1) +
                               " m from where the pictures put it (at most " + format_fixed(up_limit_m, 1) + " m)");
    }
    const double turned_deg = std::remainder(start.turned_deg[i] - usual_turn_deg, 360);
    if (block.measured[i].enu_from_camera && std::abs(turned_deg) > kLargestTurn_deg) {
      found.warnings.push_back(path + ": its heading is " + format_fixed(std::abs(turned_deg), 0) +
                               "° from what the pictures show, and was not believed");
    }
  }
  return found;
}

void refuse_control_contradictions(const CaptureFrames& frames, const Block& block, const AdjustedBlock& adjusted,
                                   double gsd_m) {
  std::vector<std::string> problems;
  const double limit_m = kContradiction * std::hypot(block.control_sigma_m, gsd_m);
  for (std::size_t i = 0; i < block.control_points.size(); ++i) {
    const auto& [miss_m, frame] = adjusted.control_misses[i];
    if (!(miss_m <= limit_m)) {
      problems.push_back("control point \"" + block.control_points[i].name + "\" lies " + format_fixed(miss_m, 2) +
                         " m from where its mark in " + frames.frames[static_cast<std::size_t>(frame)].path +
                         " puts it (at most " + format_fixed(limit_m, 2) + " m)");
    }
  }
  if (problems.empty()) return;
  throw DataError(join(problems, "; ") + "; correct or remove it, or give a larger --control-sigma-m");
}

std::vector<FramePair> shared_points(const AdjustedBlock& adjusted) {
  std::map<std::array<int, 2>, int> counts;
  for (const AdjustedPoint& point : adjusted.points) {
    for (std::size_t i = 0; i < point.sightings.size(); ++i) {
      for (std::size_t j = i + 1; j < point.sightings.size(); ++j) {
        ++counts[{point.sightings[i].frame, point.sightings[j].frame}];
      }
    }
  }
  std::vector<FramePair> pairs;
  for (const auto& [frames, count] : counts) {
    if (count >= kFewestShared) pairs.push_back({frames[0], frames[1], {}});
  }
  return pairs;
}

}  // namespace pilotage
