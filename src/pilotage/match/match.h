#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "pilotage/base/options.h"
#include "pilotage/base/progress.h"
#include "pilotage/camera/attitude.h"
#include "pilotage/camera/camera.h"
#include "pilotage/geo/geodetic_point.h"
#include "pilotage/geo/position_covariance.h"
#include "pilotage/mapdb/map_reader.h"

#pragma GCC visibility push(default)

namespace pilotage {

/// What the aircraft knows when the frame is taken.
struct MatchPrior {
  GeodeticPoint position;  ///< Of the aircraft.
  /// Of the position: variances of east and north and their covariance, m²; isotropic_covariance_m2() for one sigma.
  Eigen::Matrix2d covariance_en_m2 = Eigen::Matrix2d::Zero();
  double height_agl_m = 0;  ///< Above the ground under the aircraft.
  Attitude attitude;        ///< Yaw from true north.
};

/// How sure the prior is, how far is searched, and what is accepted. The defaults are those that docs/methods/match.md
/// measures.
struct MatchOptions {
  double search_sigmas = 3;
  double attitude_sigma_deg = 1;
  double yaw_sigma_deg = 1;
  double height_sigma_fraction = 0.03;
  std::optional<double> map_sigma_m;
  std::optional<double> elevation_sigma_m;
  double max_false_fix_rate = 0.001;
  bool chips = true;
  bool landmarks = true;
  double max_memory_mib = 512;
  std::optional<double> deadline_ms;

  template <class Self, class Fields>
  static void describe(Self& self, Fields& fields) {
    fields.field(
        "search_sigmas", self.search_sigmas,
        "Half width of the searched square, in standard deviations of the prior position along its worst direction.",
        Range{0.5, 10});
    fields.field("attitude_sigma_deg", self.attitude_sigma_deg, "Standard deviation of pitch and roll.",
                 Range{0.01, 20});
    fields.field(
        "yaw_sigma_deg", self.yaw_sigma_deg,
        "Standard deviation of yaw; 180 for an unknown heading. Above 3 headings are tried one after the other.",
        Range{0.01, 180});
    fields.field("height_sigma_fraction", self.height_sigma_fraction,
                 "Standard deviation of the height above ground, as a share of it.", Range{1e-4, 0.5});
    fields.field(
        "map_sigma_m", self.map_sigma_m,
        "Standard deviation, along each axis, of the map's own georeference. Default: what the map says of the "
        "tile that is seen, else 1.",
        Range{0, 100});
    fields.field("elevation_sigma_m", self.elevation_sigma_m,
                 "Standard deviation of the map's ground heights, where it has any: about 1 of a lidar's model, 4 of a "
                 "global one from radar. Default: what the map says, else 1.",
                 Range{0, 100});
    fields.field("max_false_fix_rate", self.max_false_fix_rate,
                 "Largest share of false fixes among frames that show other ground; sets the confidence asked for.",
                 Range{1e-6, 0.5});
    fields.field("chips", self.chips, "Use the map's chips where it has them.");
    fields.field("landmarks", self.landmarks, "Use the map's landmarks where it has them.");
    fields.field("max_memory_mib", self.max_memory_mib,
                 "Memory that matching one frame may take; a frame estimated to need more is too_uncertain.",
                 Range{0, 1e6});
    fields.field("deadline_ms", self.deadline_ms,
                 "Time for one frame; without an answer by then it is out_of_time. Without it there is no limit.",
                 Range{0, 1e9});
  }
};

enum class MatchStatus {
  kFix,
  kBadFrame,        ///< Not an 8-bit gray picture of the camera's size.
  kBadPrior,        ///< Not finite, not on Earth, or no height above ground.
  kBadCamera,       ///< camera_problem() finds one.
  kBadOptions,      ///< An option is outside its range.
  kTooUncertain,    ///< To search the prior's window takes more memory or work than is allowed.
  kOutOfTime,       ///< The deadline passed.
  kNoMap,           ///< The map has no feature within the search window, and fewer than three landmarks are seen.
  kMapUnreadable,   ///< The map's file is damaged here.
  kNoGround,        ///< The frame shows no ground: it looks at the sky.
  kTooFewFeatures,  ///< Frame or map has too little texture.
  kAmbiguous,       ///< Another place in the window looks as good, or another map says another place.
  kInconsistent,    ///< The best place explains too little of the frame.
  kOutsideGate,     ///< The best place contradicts the prior position, attitude or height.
  kOutOfMemory,     ///< Memory ran out; the next frame may find some.
};

/// "fix", "no_map" …: the word in files.
std::string_view match_status_name(MatchStatus status);
/// A sentence for people.
std::string_view match_status_text(MatchStatus status);

/// Where the aircraft is. East and north are those of the fix's own place.
struct Fix {
  GeodeticPoint position;  ///< The aircraft: the point straight below it.
  /// Of position: variances of east and north and their covariance, m². Includes map_sigma_m and what the attitude's
  /// error leaves open.
  Eigen::Matrix2d covariance_en_m2 = Eigen::Matrix2d::Zero();
  GeodeticPoint center;  ///< The point on the ground that the camera's principal point shows.
  Eigen::Matrix2d center_covariance_en_m2 = Eigen::Matrix2d::Zero();
  double yaw_deg = 0;  ///< Refined attitude and height, and their standard deviations.
  double pitch_deg = 0;
  double roll_deg = 0;
  double yaw_sigma_deg = 0;
  double height_agl_m = 0;
  double height_sigma_m = 0;
  double scale = 1;  ///< height_agl_m over the prior's.
  /// Of the map's own georeference, each axis; part of both covariances. Of the tile, without one of the tile that lies
  /// worst, then at least 1.
  double map_sigma_m = 0;
  /// Whether fixes share that error: not where several maps were asked, whose errors are not the same.
  bool map_error_is_shared = true;
  /// The map's tile under the principal point, or the nearest; none where no feature is stored within the window: a fix
  /// by landmarks.
  std::optional<std::int64_t> tile_id;
};

/// How the answer came about. Zero where the pipeline did not get that far.
struct MatchStats {
  int level = -1;
  double gsd_m = 0;
  int frame_features = 0;
  int map_features = 0;
  double support = 0;         ///< GuidedMatch::evidence() of the best place: what features say for it.
  int expected_features = 0;  ///< Features of the map that the frame should show there.
  double vote_peak = 0;  ///< Evidence for the best place: place_evidence(), −ln of the rate of such evidence elsewhere.
  double vote_rival =
      0;            ///< The same for the best place elsewhere, 12 m away or a rival nearby (MatchStatus::kAmbiguous).
  int inliers = 0;  ///< Pairs of features that agree with the refined pose.
  double residual_m = 0;  ///< Their root mean square, along one axis.
  double ncc = 0;         ///< Normalised correlation with the map's chips, when they were used; else 0.
  double ncc_rival = 0;
  int chip_pixels = 0;             ///< Pixels of chips behind ncc; 0 when they were not used.
  double agreement = 0;            ///< Of the directions of edges with the chips', σ above other places; 0 likewise.
  double confidence = 0;           ///< 1 − the rate at which frames of other ground reach this evidence, 0 … 1.
  double search_half_width_m = 0;  ///< Of the square that was searched.
  int landmarks_seen = 0;          ///< What the map's detectors found on the frame.
  int landmarks_expected = 0;      ///< Landmarks of the map that the frame should show at the best place,
  int landmarks_matched = 0;       ///< and how many of them lie under what was seen.
};

struct MatchResult {
  MatchStatus status = MatchStatus::kBadFrame;
  std::optional<Fix> fix;  ///< Exactly when status is kFix.
  /// The best place even when it is refused, for people and statistics; never to be used for navigation.
  std::optional<Fix> candidate;
  MatchStats stats;
  std::size_t map_index = 0;  ///< Of the maps that were asked, in their order: the one whose answer this is.
  /// What each of them said by itself, in their order; none of options or a prior that are no question to any.
  std::vector<MatchStatus> map_statuses;
};

/// Finds the aircraft: the frame is rectified onto the ground with the prior attitude and height, its features are
/// compared with the map's inside the search window, displacements vote, the best pose is refined and accepted or
/// refused. docs/methods/match.md has the method and its measurements.
///
/// `frame` is CV_8UC1 of the camera's size. The answer is a status for any frame, prior, camera and options, and for a
/// damaged map, and when memory runs out: nothing is thrown but, when `go_on` returns false, Interrupted. `go_on` may
/// be empty; it is called every few milliseconds by the calling thread. Re-entrant; one MapReader serves one thread at
/// a time.
///
/// Memory is estimated from above before it is taken, and the window before the frame is looked at: kTooUncertain comes
/// early and, like every other answer, is the same each time. It also answers windows of more than some 4,000 pixels of
/// the level to each side, and searches of more than 2·10¹⁰ comparisons or 10⁹ bins (many seconds). Beyond
/// max_memory_mib come what the MapReader keeps (its cache_bytes) and the tile it is decoding.
///
/// Time: the deadline counts from the call and is looked at every few milliseconds, but not while the frame is
/// rectified (some 10 ms for each megapixel). kOutOfTime is the only answer that depends on how fast the machine is; a
/// deadline of 0 is past before anything is done.
MatchResult match(const cv::Mat& frame, const MatchPrior& prior, const Camera& camera, MapReader& map,
                  const MatchOptions& options = {}, const std::function<bool()>& go_on = {});

/// The same where several maps hold the ground, such as maps of its imagery of different dates: each is asked, and
/// together they give a false fix no more often than max_false_fix_rate says, for of n maps each may do so at a n-th of
/// that rate. The fix is that of the map with the most evidence for its place. It is withdrawn, kAmbiguous, where
/// another map has a fix more than 12 m away, or farther than their covariances let two right ones be; where it does
/// not lead another map's place so far away as it must lead a rival; where another map is sure of the same place, but
/// the lead of both together over their rivals is too small. Where no map has a fix the answer is that of a map that
/// could not be searched (kOutOfMemory, kMapUnreadable, kOutOfTime, kTooUncertain), else that with the most evidence,
/// else of the one that came farthest. docs/methods/several-maps.md.
///
/// Maps are asked one after the other: time and evidence are those of all of them, memory that of the one that takes
/// most. The deadline is one for all, and a fix of a map that was asked before it stands; so with a deadline a fix may
/// depend, too, on how fast the machine is. Of no map at all the answer is kNoMap. A map that
/// stands there twice is asked twice; none may be null.
MatchResult match(const cv::Mat& frame, const MatchPrior& prior, const Camera& camera, std::span<MapReader* const> maps,
                  const MatchOptions& options = {}, const std::function<bool()>& go_on = {});

}  // namespace pilotage

#pragma GCC visibility pop
