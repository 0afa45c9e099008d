#include "pilotage/flightlog/frame_match.h"

#include <chrono>
#include <cmath>
#include <new>

#include <Eigen/LU>

#include "pilotage/base/error.h"
#include "pilotage/geo/local_frame.h"
#include "pilotage/mapdb/parallel_reading.h"
#include "pilotage/raster/gdal_gray.h"

namespace pilotage {
namespace {

constexpr double kBytesPerPixel = 5;  ///< To read a picture: its colours, its gray and what of it is valid.

/// To read the picture takes more than MatchOptions::max_memory_mib.
struct TooLarge {};

double milliseconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace

std::string frame_status_name(const FrameMatch& match) {
  return match.readable() ? std::string(match_status_name(match.result.status)) : "unreadable";
}

std::string frame_status_text(const FrameMatch& match) {
  return match.readable() ? std::string(match_status_text(match.result.status)) : match.problem;
}

std::vector<std::string> match_status_names(std::span<const MatchStatus> statuses) {
  std::vector<std::string> names;
  for (const MatchStatus status : statuses) names.emplace_back(match_status_name(status));
  return names;
}

Outcome outcome_of_fix(double error_m, double correct_within_m) {
  if (std::isnan(error_m)) return Outcome::kUnjudged;
  return error_m <= correct_within_m ? Outcome::kCorrect : Outcome::kFalse;
}

FixError error_of_fix(const Fix& fix, GeodeticPoint truth, FrameTruth kind) {
  const bool nadir = kind == FrameTruth::kNadir;
  const Eigen::Matrix2d& covariance = nadir ? fix.covariance_en_m2 : fix.center_covariance_en_m2;
  const LocalFrame at_truth(truth);
  const Eigen::Vector2d error = at_truth.enu_from_geodetic(nadir ? fix.position : fix.center).head<2>();
  FixError result{error.x(), error.y(), error.norm(), std::numeric_limits<double>::quiet_NaN()};
  if (covariance.determinant() > 0 && covariance(0, 0) > 0) result.nees = error.dot(covariance.inverse() * error);
  return result;
}

void set_errors(FrameMatch& match) {
  const FrameRecord& frame = match.frame;
  const FrameTruth judged = frame.true_nadir ? FrameTruth::kNadir : FrameTruth::kCenter;
  const auto error_of = [](const std::optional<Fix>& fix, const std::optional<GeodeticPoint>& truth, FrameTruth kind) {
    return fix && truth ? std::optional(error_of_fix(*fix, *truth, kind)) : std::nullopt;
  };
  match.error = error_of(match.result.fix, frame.truth(), judged);
  match.center_error = error_of(match.result.fix, frame.true_center, FrameTruth::kCenter);
  match.candidate_error = error_of(match.result.candidate, frame.truth(), judged);
  match.candidate_center_error = error_of(match.result.candidate, frame.true_center, FrameTruth::kCenter);
}

void require_frame_was_tried(const MatchResult& result, std::span<const std::string> maps) {
  for (std::size_t i = 0; i < result.map_statuses.size(); ++i) {
    if (result.map_statuses[i] == MatchStatus::kOutOfMemory) throw std::bad_alloc();
    if (result.map_statuses[i] != MatchStatus::kMapUnreadable) continue;
    throw DataError(
        maps[i] + ": a part of it cannot be read, so that frames over it cannot be judged; pilotage verify says more");
  }
  if (result.status == MatchStatus::kOutOfMemory) throw std::bad_alloc();
}

FrameMatch match_frame(const std::string& path, const FrameRecord& frame, const Camera& camera,
                       std::span<MapReader> maps, const MatchOptions& options, const std::function<bool()>& go_on) {
  FrameMatch done;
  done.frame = frame;
  cv::Mat picture;
  Camera sized;
  try {
    picture = read_gray8_picture(path, [&](int width_px, int height_px) {
      sized = camera_for_size(path, camera, width_px, height_px);
      if (kBytesPerPixel * width_px * height_px > options.max_memory_mib * 1024 * 1024) throw TooLarge{};
    });
  } catch (const TooLarge&) {  // as match() answers what would take more memory than it may
    done.result.status = MatchStatus::kTooUncertain;
    return done;
  } catch (const DataError& error) {
    done.problem = error.what();
    return done;
  }
  const MatchPrior prior{frame.prior, frame.prior_covariance_en_m2, frame.height_agl_m, frame.attitude};
  const auto start = std::chrono::steady_clock::now();
  done.result = match(picture, prior, sized, pointers_to(maps), options, go_on);
  done.milliseconds = milliseconds_since(start);
  set_errors(done);
  return done;
}

}  // namespace pilotage
