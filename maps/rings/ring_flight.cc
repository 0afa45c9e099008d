#include "ring_flight.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "aircraft.h"
#include <Eigen/Dense>
#include <opencv2/imgproc.hpp>

#include "pilotage/base/angle.h"
#include "pilotage/geo/local_frame.h"
#include "pilotage/ins/ins_error_model.h"
#include "pilotage/match/match.h"
#include "pilotage/match/usable_fix.h"

namespace pilotage {
namespace {

constexpr double kScanRadius_m = 28;
constexpr double kScanAhead_m = 3;
constexpr double kLaps = 1.1;
constexpr double kScanFrameEach_s = 1;
constexpr int kFixesBeforeScan = 3;
constexpr double kAnswerAfter_s = 0.3;  // from the exposure to the matcher's answer
constexpr double kMapSigma_m = 0.05;    // by which the map's georeference is off, and is allowed to be
constexpr double kLeastAttitudeSigma_deg = 0.3;
constexpr double kLongest_s = 600;
constexpr double kStartFirst_deg = 45;  // before the first ring the aircraft leaves the circle of the scan
constexpr double kSameRing_m = 1;
/// What turns over a frame's exposure and mounting leave, beside the navigation's own errors.
constexpr double kMountSigma_rad = 0.1 * kRadPerDeg;

Eigen::Matrix3d body_camera(const Camera& camera) {
  return body_from_camera(camera.mount);
}

/// The world and its cameras.
struct World {
  GeodeticPoint middle;
  GroundPicture ground;
  const RingFlightOptions& options;
  Mesh mesh;

  cv::Mat frame(const Camera& camera, const FieldState& truth, Random& random) const {
    const CameraPose pose{truth.position_m, truth.enu_from_body * body_camera(camera)};
    cv::Mat rgb = rasterise(mesh, ground, camera, pose).rgb;
    if (!(options.camera_noise > 0)) return rgb;
    cv::Mat noise(rgb.size(), CV_16SC3);
    cv::RNG draws(random.next());
    draws.fill(noise, cv::RNG::NORMAL, 0, options.camera_noise);
    cv::add(rgb, noise, rgb, cv::noArray(), CV_8U);
    return rgb;
  }
};

/// An aircraft with its cameras and the matcher: flies on, step by step, and takes fixes.
class FixedAircraft {
 public:
  FixedAircraft(const World& world, MapReader& map, const Aircraft& aircraft, std::uint64_t seed)
      : world_(&world), map_(&map), aircraft_(aircraft), random_(seed) {}

  FixCounts counts;
  std::vector<PathPoint> path;

  Aircraft& aircraft() { return aircraft_; }

  /// From now on; what the matcher has not answered yet is dropped.
  void take_no_fixes() {
    takes_fixes_ = false;
    waiting_.reset();
  }

  /// Whether a frame that looks down was exposed with the last step.
  bool looked_down() const { return looked_down_; }

  void fly(const Eigen::Vector3d& velocity_mps, double heading_deg) {
    looked_down_ = false;
    heading_.reset();
    aircraft_.fly(velocity_mps, heading_deg);
    if (takes_fixes_ && aircraft_.time_s() >= next_frame_s_) look_down();
    if (waiting_ && aircraft_.time_s() >= waiting_->due_s) {
      const FixUpdate update = aircraft_.filter().take_fix(waiting_->frame, waiting_->measurement);
      const bool taken = update.outcome == FixOutcome::kTaken || update.outcome == FixOutcome::kReset;
      counts.taken += taken ? 1 : 0;
      counts.refused += taken ? 0 : 1;
      waiting_.reset();
    }
    const Eigen::Matrix3d covariance_m2 = aircraft_.pose_covariance().topLeftCorner<3, 3>();
    path.push_back({aircraft_.time_s(), aircraft_.truth().position_m, aircraft_.believed().position_m, covariance_m2});
  }

  /// What is seen now, with the heading of the fix where one was taken with the same step: the filter takes none.
  RingSight sight(const SeenRing& seen, const Camera& camera) {
    const FieldState believed = aircraft_.believed();
    RingSight sight{
        seen, {believed.position_m, believed.enu_from_body * body_camera(camera)}, aircraft_.pose_covariance()};
    if (heading_) {
      const Eigen::AngleAxisd turn(heading_->correction_rad, Eigen::Vector3d::UnitZ());
      sight.pose.enu_from_camera = turn * sight.pose.enu_from_camera;
      sight.pose_covariance.row(5).setZero();
      sight.pose_covariance.col(5).setZero();
      sight.pose_covariance(5, 5) = heading_->sigma_rad * heading_->sigma_rad;
    }
    sight.pose_covariance.diagonal().tail<3>().array() += kMountSigma_rad * kMountSigma_rad;
    return sight;
  }

  cv::Mat look(const Camera& camera) { return world_->frame(camera, aircraft_.truth(), random_); }

 private:
  struct Waiting {
    FrameNumber frame;
    PositionMeasurement measurement;
    double due_s;
  };

  struct Heading {
    double correction_rad;  ///< To be turned by about up.
    double sigma_rad;
  };

  void look_down() {
    looked_down_ = true;
    next_frame_s_ = aircraft_.time_s() + world_->options.fix_interval_s;
    const Camera camera = down_camera();
    cv::Mat gray;
    cv::cvtColor(look(camera), gray, cv::COLOR_RGB2GRAY);
    NavigationFilter& filter = aircraft_.filter();
    const FrameNumber frame = filter.take_frame();
    const std::optional<MatchPrior> prior = filter.match_prior(frame, filter.estimate().height_m);
    const MatchOptions options = match_options();
    ++counts.frames;
    if (!prior) return;
    const MatchResult result = match(gray, *prior, camera, *map_, options);
    if (!has_usable_fix(result)) return;
    ++counts.fixes;
    const Eigen::Vector3d at = LocalFrame(world_->middle).enu_from_geodetic(result.fix->position);
    counts.squared_error_m2 += (at - aircraft_.truth().position_m).head<2>().squaredNorm();
    // Headings are counted clockwise.
    const double off_deg = std::remainder(result.fix->yaw_deg - prior->attitude.yaw_deg, 360.0);
    heading_ = {-off_deg * kRadPerDeg, result.fix->yaw_sigma_deg * kRadPerDeg};
    waiting_ = {frame, without_prior(*result.fix, *prior), aircraft_.time_s() + kAnswerAfter_s};
  }

  /// As sure of the attitude as the filter is.
  MatchOptions match_options() {
    const auto sigma_deg = [variances = aircraft_.pose_covariance().diagonal().eval()](int i) {
      return std::max(kLeastAttitudeSigma_deg, std::sqrt(variances[i]) / kRadPerDeg);
    };
    MatchOptions options;
    options.map_sigma_m = kMapSigma_m;
    options.attitude_sigma_deg = std::max(sigma_deg(3), sigma_deg(4));
    options.yaw_sigma_deg = sigma_deg(5);
    return options;
  }

  const World* world_;
  MapReader* map_;
  Aircraft aircraft_;
  Random random_;
  double next_frame_s_ = 0;
  bool takes_fixes_ = true;
  bool looked_down_ = false;
  std::optional<Heading> heading_;
  std::optional<Waiting> waiting_;
};

double heading_to(const Eigen::Vector3d& along) {
  return std::atan2(along.x(), along.y()) / kRadPerDeg;
}

/// Around the field clockwise, nose to its middle.
void fly_circle(FixedAircraft& flier, double speed_mps) {
  const Eigen::Vector3d at = flier.aircraft().believed().position_m;
  const double ahead_deg = kScanAhead_m / kScanRadius_m / kRadPerDeg;
  const Eigen::Vector3d carrot =
      kScanRadius_m * direction(bearing_deg(at) + ahead_deg, 0) + kScanHeight_m * Eigen::Vector3d::UnitZ();
  flier.fly(speed_mps * (carrot - at).normalized(), heading_to(-at));
}

std::vector<RingSight> scan(FixedAircraft& flier, const RingFlightOptions& options, RingFlight& flight) {
  std::vector<RingSight> sights;
  const Camera camera = forward_camera();
  double turned_deg = 0;
  double next_frame_s = 0;
  while (turned_deg < 360 * kLaps && flier.aircraft().time_s() < kLongest_s) {
    const double before = bearing_deg(flier.aircraft().believed().position_m);
    fly_circle(flier, options.scan_speed_mps);
    if (flier.counts.taken < kFixesBeforeScan) continue;
    turned_deg += std::remainder(bearing_deg(flier.aircraft().believed().position_m) - before, 360.0);
    if (!flier.looked_down() && flier.aircraft().time_s() < next_frame_s) continue;
    next_frame_s = flier.aircraft().time_s() + kScanFrameEach_s;
    ++flight.scan_frames;
    DetectionCounts counts;
    for (const SeenRing& seen : detect_rings(flier.look(camera), &counts)) sights.push_back(flier.sight(seen, camera));
    flight.detections.patches += counts.patches;
    flight.detections.no_hole += counts.no_hole;
    flight.detections.cut += counts.cut;
    flight.detections.too_thin += counts.too_thin;
    flight.detections.no_ellipse += counts.no_ellipse;
    flight.detections.rings += counts.rings;
  }
  return sights;
}

/// On along the circle to where the course is entered.
void fly_to_entry(FixedAircraft& flier, const std::vector<LocatedRing>& rings, const RingFlightOptions& options) {
  if (rings.empty()) return;
  const double entry_deg = bearing_deg(rings.front().center_m) - kStartFirst_deg;
  const auto beyond_deg = [&] {
    return std::remainder(bearing_deg(flier.aircraft().believed().position_m) - entry_deg, 360.0);
  };
  double before = beyond_deg();
  while (flier.aircraft().time_s() < kLongest_s) {
    fly_circle(flier, options.scan_speed_mps);
    const double now = beyond_deg();
    if (before < 0 && now >= 0 && now < 90) return;
    before = now;
  }
}

void fly_course(FixedAircraft& flier, const std::vector<LocatedRing>& rings, const RingFlightOptions& options) {
  flier.path.clear();
  flier.counts = {};
  const Eigen::Vector3d from = flier.aircraft().believed().position_m;
  const double begun_s = flier.aircraft().time_s();
  Follower follower(line_through(rings, from, direction(bearing_deg(from) + 90, 0)), options.speed_mps,
                    0.6 * options.speed_mps);
  while (!follower.arrived() && flier.aircraft().time_s() < begun_s + kLongest_s) {
    const Eigen::Vector3d velocity = follower.velocity_mps(flier.aircraft().believed().position_m);
    flier.fly(velocity, heading_to(velocity));
  }
}

JudgedRing judge_ring(const LocatedRing& ring, const RingFlight& flight, std::vector<bool>& taken) {
  JudgedRing judged{.ring = ring};
  double least_m = kSameRing_m;
  for (std::size_t i = 0; i < flight.scene.rings.size(); ++i) {
    const double apart_m = (ring.center_m - flight.scene.rings[i].center_m).norm();
    if (taken[i] || flight.scene.rings[i].ring_class != ring.ring_class || apart_m >= least_m) continue;
    least_m = apart_m;
    judged.truth = static_cast<int>(i);
  }
  if (judged.truth < 0) return judged;
  taken[static_cast<std::size_t>(judged.truth)] = true;
  const Ring& truth = flight.scene.rings[static_cast<std::size_t>(judged.truth)];
  const Eigen::Vector3d off = ring.center_m - truth.center_m;
  judged.error_m = off.norm();
  judged.nees = off.dot(ring.covariance_m2.ldlt().solve(off));
  judged.azimuth_error_deg = std::remainder(ring.azimuth_deg - truth.azimuth_deg, 180.0);
  judged.radius_error_m = ring.inner_radius_m - truth.kind().inner_radius_m;
  judged.nearest_view_m = std::numeric_limits<double>::infinity();
  for (const PathPoint& point : flight.scan) {
    judged.nearest_view_m = std::min(judged.nearest_view_m, (point.position_m - truth.center_m).norm());
  }
  return judged;
}

/// Across the axis, the worst direction.
double planned_clearance(const LocatedRing& ring, const Eigen::Matrix3d& own_m2, double half_span_m) {
  const Eigen::Vector3d normal = direction(ring.azimuth_deg, ring.lean_deg);
  const Eigen::Matrix3d across = Eigen::Matrix3d::Identity() - normal * normal.transpose();
  const Eigen::Matrix3d both = across * (ring.covariance_m2 + own_m2) * across;
  const double most_m2 = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(both).eigenvalues().maxCoeff();
  return ring.inner_radius_m - half_span_m - 3 * std::sqrt(most_m2);
}

CourseFlight judged_course(FixedAircraft& flier, const RingFlight& flight, double half_span_m) {
  CourseFlight course;
  course.path = flier.path;
  course.fixes = flier.counts;
  course.outcome = judge(flight.scene, course.path, half_span_m);
  course.planned_clearance_m.assign(flight.scene.rings.size(), std::numeric_limits<double>::quiet_NaN());
  for (const JudgedRing& judged : flight.array) {
    if (judged.truth < 0) continue;
    const auto i = static_cast<std::size_t>(judged.truth);
    const Crossing& crossing = course.outcome.crossings[i];
    if (!crossing.offset_m) continue;
    course.planned_clearance_m[i] =
        planned_clearance(judged.ring, course.path[crossing.at_point].covariance_m2, half_span_m);
  }
  if (!course.path.empty()) {
    course.end_error_m = (course.path.back().believed_m - course.path.back().position_m).head<2>().norm();
  }
  return course;
}

}  // namespace

Camera down_camera() {
  return {320, 240, 190, 190, 160, 120};
}

Camera forward_camera() {
  Camera camera{800, 600, 500, 500, 400, 300};
  camera.mount.pitch_deg = 70;
  return camera;
}

RingFlight fly_rings(const RingField& field, MapReader& map, const RingFlightOptions& options, std::uint64_t seed) {
  RingFlight flight;
  flight.scene = make_ring_scene(options.scene, seed);
  Random random(derive_seed(seed, seed_from_name("map")));
  const double off_east_m = kMapSigma_m * random.normal();
  GroundPicture ground = field.picture;
  ground.origin_px += ground.pixel_from_enu_m * Eigen::Vector2d(off_east_m, kMapSigma_m * random.normal());
  const World world{field.middle, ground, options, mesh_of(flight.scene)};
  InsOptions ins = options.ins;
  if (!ins.grade && !ins.name) ins.grade = InsGrade::kConsumer;
  const Eigen::Vector3d start = {0, kScanRadius_m, kScanHeight_m};
  const Aircraft aircraft(field.middle, make_ins_error_model(ins), kMapSigma_m, start, 180, seed);
  FixedAircraft flier(world, map, aircraft, derive_seed(seed, seed_from_name("cameras")));

  const std::vector<RingSight> sights = scan(flier, options, flight);
  flight.sights = static_cast<int>(sights.size());
  RingArray array = locate_rings(sights, forward_camera());
  flight.refused = array.refused;
  const std::vector<LocatedRing> rings = in_order(array.rings);
  fly_to_entry(flier, rings, options);
  flight.scan = flier.path;
  flight.scan_fixes = flier.counts;
  std::vector<bool> taken(flight.scene.rings.size(), false);
  for (const LocatedRing& ring : rings) {
    flight.array.push_back(judge_ring(ring, flight, taken));
    (flight.array.back().truth >= 0 ? flight.found : flight.false_rings) += 1;
  }

  FixedAircraft control = flier;
  control.take_no_fixes();
  fly_course(flier, rings, options);
  flight.with_fixes = judged_course(flier, flight, options.half_span_m);
  fly_course(control, rings, options);
  flight.without_fixes = judged_course(control, flight, options.half_span_m);
  return flight;
}

}  // namespace pilotage
