#include "pilotage/match/match.h"

#include <cmath>
#include <cstdlib>
#include <optional>

#include <opencv2/core.hpp>

#include "pilotage/base/error.h"
#include "pilotage/match/frame_on_grid.h"
#include "pilotage/match/local_map.h"
#include "pilotage/match/match_confidence.h"
#include "pilotage/match/place_ranking.h"
#include "pilotage/match/refined_fix.h"

namespace pilotage {
namespace {

constexpr double kMaxSearchBins = 1e9;  // some ten seconds
constexpr int kMinFeatures = 20;
constexpr double kMinLead = 3;  // of the best place over its rival, in natural logarithms

bool is_inside(double value, double low, double high) {
  return value >= low && value <= high;
}

bool options_are_good(const MatchOptions& options) {
  // check_options() throws; matching does not.
  try {
    check_options(options);
  } catch (const UsageError&) {
    return false;
  }
  return true;
}

bool prior_is_good(const MatchPrior& prior) {
  return std::isfinite(prior.position.lon_deg) && is_inside(prior.position.lon_deg, -360, 360) &&
         is_inside(prior.position.lat_deg, -90, 90) && is_inside(prior.sigma_m, 1e-3, 1e5) &&
         is_inside(prior.height_agl_m, 1e-3, 1e5) && std::isfinite(prior.attitude.yaw_deg) &&
         std::isfinite(prior.attitude.pitch_deg) && std::isfinite(prior.attitude.roll_deg);
}

std::optional<FeatureOptions> feature_options(const MapReader& map) {
  FeatureOptions options;
  if (const auto bits = map.info().find("features.descriptor_bits")) options.descriptor_bits = std::atoi(bits->c_str());
  options.oriented = map.info().find("features.oriented") == "true";
  if (options.descriptor_bits != 128 && options.descriptor_bits != 256 && options.descriptor_bits != 512) {
    return std::nullopt;
  }
  return options;
}

MatchResult match_or_throw(const cv::Mat& frame, const MatchPrior& prior, const Camera& camera, MapReader& map,
                           const MatchOptions& options) {
  MatchResult result;
  const FrameOnGrid laid = lay_frame_on_grid(frame, prior, camera, map, options);
  result.status = laid.status;
  if (laid.level != nullptr) result.stats.level = laid.level->matrix.level;
  result.stats.gsd_m = laid.gsd_m;
  if (result.status != MatchStatus::kFix) return result;
  const auto features = feature_options(map);
  if (!features) return {MatchStatus::kMapUnreadable, {}, {}, result.stats};

  const PivotedFrame described = describe(laid, *features);
  const Eigen::Vector2d center_px = laid.prior_px + laid.px_from_m(laid.pivot_m);
  const LocalMap local =
      read_local_map(map, *laid.level, laid.grid, center_px, laid.half_width_px + described.radius_px);
  result.stats.frame_features = static_cast<int>(described.grid.points.size());
  result.stats.map_features = static_cast<int>(local.features.size());
  if (local.features.size() > 0 && local.features.descriptor_bytes * 8 != features->descriptor_bits) {
    return {MatchStatus::kMapUnreadable, {}, {}, result.stats};
  }
  if (local.features.size() == 0) return {MatchStatus::kNoMap, {}, {}, result.stats};
  if (result.stats.frame_features < kMinFeatures || result.stats.map_features < kMinFeatures) {
    return {MatchStatus::kTooFewFeatures, {}, {}, result.stats};
  }

  const SearchSpace space = search_space(laid, local, options, features->oriented);
  if (search_bins(described, space) > kMaxSearchBins) return {MatchStatus::kBadPrior, {}, {}, result.stats};
  const auto chips = compare_chips(frame, prior, camera, map, options, laid, described, local);
  const auto places = rank_places(described, local, space, chips, laid.gsd_m);
  if (!places) return {MatchStatus::kInconsistent, {}, {}, result.stats};
  const RankedPlace& best = places->best;
  result.stats.support = best.match.evidence();
  result.stats.expected_features = best.match.expected;
  result.stats.vote_peak = best.evidence;
  result.stats.vote_rival = places->rival_evidence;
  result.stats.ncc = best.ncc;
  result.stats.ncc_rival = places->rival_ncc;
  result.stats.chip_pixels = best.compared_px;
  result.stats.confidence = 1 - false_fix_rate(best.evidence);
  auto refined = refine_fix(laid, described, local, prior, options, best.match);
  if (!refined) return {MatchStatus::kInconsistent, {}, {}, result.stats};
  result.stats.inliers = refined->pose.inliers;
  result.stats.residual_m = refined->pose.residual_m;
  result.candidate = refined->fix;
  if (1 - result.stats.confidence > options.max_false_fix_rate) {
    result.status = MatchStatus::kInconsistent;
  } else if (places->best.evidence - places->rival_evidence < kMinLead) {
    result.status = MatchStatus::kAmbiguous;
  } else if (is_outside_gate(laid, local, prior, options, refined->pose)) {
    result.status = MatchStatus::kOutsideGate;
  } else {
    result.fix = refined->fix;
  }
  return result;
}

}  // namespace

MatchResult match(const cv::Mat& frame, const MatchPrior& prior, const Camera& camera, MapReader& map,
                  const MatchOptions& options) {
  if (!options_are_good(options)) return {MatchStatus::kBadOptions, {}, {}, {}};
  if (!prior_is_good(prior)) return {MatchStatus::kBadPrior, {}, {}, {}};
  try {
    return match_or_throw(frame, prior, camera, map, options);
  } catch (const DataError&) {
    return {MatchStatus::kMapUnreadable, {}, {}, {}};
  } catch (const UsageError&) {
    return {MatchStatus::kBadPrior, {}, {}, {}};
  } catch (const cv::Exception&) {  // OpenCV refuses a picture in its own way
    return {MatchStatus::kBadFrame, {}, {}, {}};
  }
}

}  // namespace pilotage
