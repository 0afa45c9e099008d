#include "pilotage/capture/adjust_block.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>

#include <Eigen/Dense>
#include <Eigen/Geometry>
#include <ceres/ceres.h>

#include "pilotage/base/angle.h"
#include "pilotage/base/error.h"
#include "pilotage/base/nan.h"
#include "pilotage/base/statistics.h"
#include "pilotage/camera/lens.h"
#include "pilotage/capture/block_residuals.h"
#include "pilotage/capture/frame_errors.h"

namespace pilotage {
namespace {

constexpr double kPriorLoss = 3;  // standard deviations
constexpr double kHeightBiasSigma_m = 5;
constexpr double kFreeHeightSigma_m = 1000;
constexpr double kClockSigma_s = 0.5;
constexpr double kBoresightSigma_deg = 5;
/// Marks that people or programs put into pictures.
constexpr double kMarkSigma_px = 1;
constexpr double kGroundParts = 25;
constexpr double kOutlierSigmas = 4;
constexpr double kLargestErrorSigmas = 15;
constexpr int kIterations = 60;
constexpr std::size_t kFewestSightings = 30;

/// turn(3) against the pose that the round begins with, centre(3).
using PoseBlock = std::array<double, 6>;

/// z = a·e + b·n + c.
struct Plane {
  Eigen::Vector3d coefficients{0, 0, 0};
  double spread_m = 0;  ///< Robust standard deviation of the points around it.

  double height_m(const Eigen::Vector3d& enu_m) const {
    return coefficients.dot(Eigen::Vector3d(enu_m.x(), enu_m.y(), 1));
  }
};

/// Least squares with Cauchy's weights.
Plane fit_plane(const std::vector<AdjustedPoint>& points) {
  Plane plane;
  std::vector<double> heights_m;
  for (const AdjustedPoint& point : points) heights_m.push_back(point.enu_m.z());
  plane.coefficients.z() = quantile(heights_m, 0.5);
  for (int round = 0; round < 10; ++round) {
    std::vector<double> distances_m;
    for (const AdjustedPoint& point : points)
      distances_m.push_back(std::abs(point.enu_m.z() - plane.height_m(point.enu_m)));
    plane.spread_m = 1.4826 * quantile(distances_m, 0.5);
    const double width_m = std::max(plane.spread_m, 0.01);
    Eigen::Matrix3d normal = 1e-9 * Eigen::Matrix3d::Identity();
    Eigen::Vector3d right(0, 0, 0);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Eigen::Vector3d row(points[i].enu_m.x(), points[i].enu_m.y(), 1);
      const double w = 1 / (1 + distances_m[i] * distances_m[i] / (width_m * width_m));
      normal += w * row * row.transpose();
      right += w * row * points[i].enu_m.z();
    }
    plane.coefficients = normal.ldlt().solve(right);
  }
  return plane;
}

/// Stops Ceres when the caller wishes it.
class Watch : public ceres::IterationCallback {
 public:
  Watch(const Progress& progress, int round) : progress_(progress), round_(round) {}

  ceres::CallbackReturnType operator()(const ceres::IterationSummary& summary) override {
    if (progress_ && !progress_("adjusting the block", round_ * kIterations + summary.iteration, 2 * kIterations)) {
      stopped_ = true;
      return ceres::SOLVER_ABORT;
    }
    return ceres::SOLVER_CONTINUE;
  }
  bool stopped() const { return stopped_; }

 private:
  const Progress& progress_;
  int round_;
  bool stopped_ = false;
};

class Adjustment {
 public:
  Adjustment(const Block& block, const BlockStart& start, const std::vector<Track>& tracks, const GroundPrior& ground)
      : block_(block), ground_(ground), camera_(block.camera), lens_{0, camera_.distortion[0], camera_.distortion[1]} {
    for (const FramePose& pose : start.poses) {
      camera_from_enu_.push_back(pose.enu_from_camera.transpose());
      poses_.push_back({0, 0, 0, pose.center_enu_m.x(), pose.center_enu_m.y(), pose.center_enu_m.z()});
    }
    has_velocity_ = std::any_of(block.measured.begin(), block.measured.end(),
                                [](const MeasuredPose& one) { return one.velocity_enu_mps.has_value(); });
    place_points(tracks, start);
    place_control_points();
    for (const ReferenceTie& tie : block.reference_ties) ties_.push_back(tie.enu_m);
  }

  void solve(int round, const Progress& progress) {
    ceres::Problem problem;
    add_all(problem);
    ceres::Solver::Options options;
    options.linear_solver_type = ceres::SPARSE_SCHUR;
    options.max_num_iterations = kIterations;
    options.function_tolerance = 1e-7;
    options.num_threads = 1;
    options.logging_type = ceres::SILENT;
    Watch watch(progress, round);
    options.callbacks.push_back(&watch);
    ceres::Solver::Summary summary;
    ceres::Solve(options, &problem, &summary);
    if (watch.stopped()) throw Interrupted{};
    converged_ = summary.termination_type == ceres::CONVERGENCE;
    if (!summary.IsSolutionUsable()) throw DataError("the block cannot be adjusted: " + summary.message);
    for (std::size_t i = 0; i < poses_.size(); ++i) {
      Eigen::Matrix3d turn;
      ceres::AngleAxisToRotationMatrix(poses_[i].data(), turn.data());
      camera_from_enu_[i] = turn * camera_from_enu_[i];
      std::fill_n(poses_[i].begin(), 3, 0.0);
    }
  }

  void drop_outliers() {
    std::vector<double> errors_px;
    for (const AdjustedPoint& point : points_) {
      for (const Sighting& one : point.sightings) errors_px.push_back(error_px(point, one).norm());
    }
    if (errors_px.empty()) return;
    const double sigma_px = quantile(errors_px, 0.5) / kMedianOfLengths;
    double found_px = 0;  // how well features were found: alike in frames of one size
    for (const FrameFeatures& frame : block_.features) found_px = std::max(found_px, frame.pixel_sigma_px);
    const double limit_px = std::clamp(kOutlierSigmas * sigma_px, 1.5 * found_px, kLargestErrorSigmas * found_px);
    for (AdjustedPoint& point : points_) {
      std::erase_if(point.sightings, [&](const Sighting& one) { return !(error_px(point, one).norm() <= limit_px); });
    }
    std::erase_if(points_, [](const AdjustedPoint& point) { return point.sightings.size() < 2; });
  }

  AdjustedBlock result(int threads, const Progress& progress) {
    AdjustedBlock done;
    done.camera = camera_;
    done.camera.fx_px *= std::exp(lens_[0]);
    done.camera.fy_px *= std::exp(lens_[0]);
    done.camera.distortion[0] = lens_[1];
    done.camera.distortion[1] = lens_[2];
    if (lens_[1] != 0 || lens_[2] != 0) done.camera.distortion_model = DistortionModel::kBrownConrady;
    done.points = points_;
    done.position_bias_m = Eigen::Vector3d(bias_.data());
    done.clock_offset_s = clock_;
    done.boresight_deg = Eigen::Vector3d(boresight_.data()) / kRadPerDeg;
    for (std::size_t i = 0; i < poses_.size(); ++i) {
      const Eigen::Vector3d center(poses_[i].data() + 3);
      done.poses.push_back({camera_from_enu_[i].transpose(), center});
      const MeasuredPose& measured = block_.measured[i];
      done.position_residuals_m.push_back(measured.center_enu_m +
                                          clock_ * measured.velocity_enu_mps.value_or(Eigen::Vector3d::Zero()) -
                                          done.position_bias_m - center);
    }
    for (std::size_t i = 0; i < control_.size(); ++i) done.control_misses.push_back(control_miss(i));
    for (std::size_t i = 0; i < ties_.size(); ++i) {
      done.tie_misses_m.push_back(
          (ties_[i].head<2>() - block_.reference_ties[i].reference_en_m - Eigen::Vector2d(reference_bias_.data()))
              .norm());
    }
    if (!ground_.height_m) done.plane = Eigen::Vector3d(plane_.data());
    done.converged = converged_;
    done.sightings_before = sightings_before_;
    sum_errors(done);
    done.frame_errors = errors_of_frames(done.poses, threads, progress);
    return done;
  }

  std::size_t sightings() const {
    std::size_t sum = 0;
    for (const AdjustedPoint& point : points_) sum += point.sightings.size();
    return sum;
  }

 private:
  const Eigen::Vector2d& pixel_of(const Sighting& one) const {
    return block_.features[static_cast<std::size_t>(one.frame)].pixels[static_cast<std::size_t>(one.feature)];
  }

  Eigen::Vector3d center(std::size_t frame) const { return Eigen::Vector3d(poses_[frame].data() + 3); }

  /// Infinite for a point behind the camera.
  Eigen::Vector2d error_px(const AdjustedPoint& point, const Sighting& one) const {
    const auto frame = static_cast<std::size_t>(one.frame);
    const Eigen::Vector3d seen = camera_from_enu_[frame] * (point.enu_m - center(frame));
    if (seen.z() < 1e-6) return Eigen::Vector2d::Constant(std::numeric_limits<double>::infinity());
    return project(camera_, lens_.data(), seen) - pixel_of(one);
  }

  /// The mark that misses it by most, at its distance, and its own displacement. Infinite behind a camera.
  ControlMiss control_miss(std::size_t i) const {
    const ControlPoint& given = block_.control_points[i];
    ControlMiss worst;
    for (const ControlPoint::Mark& mark : given.marks) {
      const auto frame = static_cast<std::size_t>(mark.frame);
      const Eigen::Vector3d seen = camera_from_enu_[frame] * (control_[i] - center(frame));
      double miss_m = std::numeric_limits<double>::infinity();
      if (seen.z() >= 1e-6) {
        const double error_px = (project(camera_, lens_.data(), seen) - mark.pixel).norm();
        miss_m = error_px * seen.z() / (camera_.fx_px * std::exp(lens_[0]));
      }
      if (miss_m >= worst.miss_m) worst = {miss_m, mark.frame};
    }
    worst.miss_m = std::hypot(worst.miss_m, (control_[i] - given.enu_m).norm());
    return worst;
  }

  /// The mean of where rays meet level ground.
  std::optional<Eigen::Vector3d> on_level_ground(const std::vector<std::pair<std::size_t, Eigen::Vector2d>>& seen,
                                                 const Lens& lens, double ground_m) const {
    Eigen::Vector3d sum(0, 0, 0);
    int count = 0;
    for (const auto& [frame, pixel] : seen) {
      const auto ray = ray_from_pixel(lens, pixel);
      if (!ray) continue;
      const Eigen::Vector3d direction = camera_from_enu_[frame].transpose() * *ray;
      const double down_m = center(frame).z() - ground_m;
      if (direction.z() > -0.1 || down_m <= 0) continue;
      sum += center(frame) + direction * (down_m / -direction.z());
      ++count;
    }
    if (count == 0) return std::nullopt;
    return sum / count;
  }

  double level_ground_m(const BlockStart& start) const {
    std::vector<double> heights_m;
    for (const PoseBlock& pose : poses_) heights_m.push_back(pose[5]);
    return quantile(heights_m, 0.5) - start.agl_m;
  }

  void place_points(const std::vector<Track>& tracks, const BlockStart& start) {
    const Lens lens = make_lens(camera_);
    const double ground_m = level_ground_m(start);
    for (const Track& track : tracks) {
      std::vector<std::pair<std::size_t, Eigen::Vector2d>> seen;
      for (const Sighting& one : track) seen.emplace_back(static_cast<std::size_t>(one.frame), pixel_of(one));
      sightings_before_ += static_cast<std::int64_t>(track.size());
      if (const auto place = on_level_ground(seen, lens, ground_m)) points_.push_back({*place, track});
    }
    // Heights of the cameras are of another origin than those of the ground: where this is known, begin there.
    if (!ground_.height_m) return;
    std::vector<double> above_m;
    for (const AdjustedPoint& point : points_) {
      const double height_m = ground_.height_m(point.enu_m.head<2>());
      if (std::isfinite(height_m)) above_m.push_back(point.enu_m.z() - height_m);
    }
    if (above_m.empty()) throw DataError("the elevation model has no height where the frames lie");
    bias_[2] = quantile(above_m, 0.5);
    for (PoseBlock& pose : poses_) pose[5] -= bias_[2];
    for (AdjustedPoint& point : points_) point.enu_m.z() -= bias_[2];
  }

  void place_control_points() {
    for (const ControlPoint& point : block_.control_points) control_.push_back(point.enu_m);
    if (control_.empty() || ground_.height_m) return;
    // Without an elevation model the control points say where the ground is.
    std::vector<double> above_m;
    for (const AdjustedPoint& point : points_) above_m.push_back(point.enu_m.z());
    std::vector<double> control_m;
    for (const Eigen::Vector3d& point : control_) control_m.push_back(point.z());
    bias_[2] = quantile(above_m, 0.5) - quantile(control_m, 0.5);
    for (PoseBlock& pose : poses_) pose[5] -= bias_[2];
    for (AdjustedPoint& point : points_) point.enu_m.z() -= bias_[2];
  }

  void add_all(ceres::Problem& problem) {
    add_frames(problem);
    add_points(problem);
    add_control_points(problem);
    if (!ties_.empty()) add_reference_ties(problem);
  }

  /// With what was left out after the last solution left out here, too.
  std::vector<FrameError> errors_of_frames(const std::vector<FramePose>& poses, int threads, const Progress& progress) {
    ceres::Problem problem;
    add_all(problem);
    ceres::Problem::EvaluateOptions at;
    at.num_threads = 1;
    for (PoseBlock& pose : poses_) at.parameter_blocks.push_back(pose.data());
    at.parameter_blocks.push_back(lens_.data());
    at.parameter_blocks.push_back(bias_.data());
    at.parameter_blocks.push_back(boresight_.data());
    if (!ground_.height_m) at.parameter_blocks.push_back(plane_.data());
    if (has_velocity_) at.parameter_blocks.push_back(&clock_);
    if (!ties_.empty()) at.parameter_blocks.push_back(reference_bias_.data());
    const int shared = 9 + (ground_.height_m ? 0 : 3) + (has_velocity_ ? 1 : 0) + (ties_.empty() ? 0 : 2);
    for (AdjustedPoint& point : points_) at.parameter_blocks.push_back(point.enu_m.data());
    for (Eigen::Vector3d& point : control_) at.parameter_blocks.push_back(point.data());
    for (Eigen::Vector3d& point : ties_) at.parameter_blocks.push_back(point.data());
    ceres::CRSMatrix jacobian;
    if (!problem.Evaluate(at, nullptr, nullptr, nullptr, &jacobian)) {
      throw DataError("the block cannot be adjusted: its residuals have no derivatives where it ends");
    }
    return frame_errors(jacobian, shared, poses, points_, !ground_.height_m, threads, progress);
  }

  bool heights_are_tied() const { return ground_.height_m || !control_.empty(); }

  void add_frames(ceres::Problem& problem) {
    for (std::size_t i = 0; i < poses_.size(); ++i) {
      const MeasuredPose& measured = block_.measured[i];
      problem.AddResidualBlock(
          cost<3, 6, 3, 1>(PositionError{measured.center_enu_m,
                                         measured.velocity_enu_mps.value_or(Eigen::Vector3d::Zero()),
                                         {measured.sigma_en_m, measured.sigma_en_m, measured.sigma_up_m}}),
          new ceres::CauchyLoss(kPriorLoss), poses_[i].data(), bias_.data(), &clock_);
      if (measured.enu_from_camera) {
        problem.AddResidualBlock(
            cost<3, 6, 3>(AttitudeError{camera_from_enu_[i], measured.enu_from_camera->transpose(),
                                        block_.tilt_sigma_deg * kRadPerDeg, block_.heading_sigma_deg * kRadPerDeg}),
            new ceres::CauchyLoss(kPriorLoss), poses_[i].data(), boresight_.data());
      } else {
        problem.AddResidualBlock(
            cost<2, 6, 3>(LevelError{camera_from_enu_[i],
                                     block_.body_from_camera.transpose() * Eigen::Vector3d(0, 0, -1),
                                     3 * block_.tilt_sigma_deg * kRadPerDeg}),
            nullptr, poses_[i].data(), boresight_.data());
      }
    }
    const double up_sigma_m = heights_are_tied() ? kFreeHeightSigma_m : kHeightBiasSigma_m;
    const double en_sigma_m = block_.position_bias_sigma_m;
    problem.AddResidualBlock(cost<3, 3>(PriorError<3>{{0, 0, 0}, {en_sigma_m, en_sigma_m, up_sigma_m}}), nullptr,
                             bias_.data());
    problem.AddResidualBlock(cost<1, 1>(ScalarError{kClockSigma_s}), nullptr, &clock_);
    if (!has_velocity_) problem.SetParameterBlockConstant(&clock_);
    const double sigma_rad = kBoresightSigma_deg * kRadPerDeg;
    problem.AddResidualBlock(cost<3, 3>(PriorError<3>{{0, 0, 0}, Eigen::Vector3d::Constant(sigma_rad)}), nullptr,
                             boresight_.data());
  }

  void add_points(ceres::Problem& problem) {
    const Plane plane = fit_plane(points_);
    plane_ = {plane.coefficients.x(), plane.coefficients.y(), plane.coefficients.z()};
    const double share = std::sqrt(static_cast<double>(points_.size()) / kGroundParts);
    const double spread_m = ground_.height_m ? ground_.sigma_m : std::max(ground_.sigma_m, plane.spread_m);
    for (AdjustedPoint& point : points_) {
      for (const Sighting& one : point.sightings) {
        const auto frame = static_cast<std::size_t>(one.frame);
        problem.AddResidualBlock(cost<2, 6, 3, 3>(SightingError{&camera_, &camera_from_enu_[frame], pixel_of(one),
                                                                block_.features[frame].pixel_sigma_px}),
                                 new ceres::CauchyLoss(2), poses_[frame].data(), point.enu_m.data(), lens_.data());
      }
      if (!ground_.height_m) {
        problem.AddResidualBlock(cost<1, 3, 3>(PlaneError{0, spread_m * share}), nullptr, point.enu_m.data(),
                                 plane_.data());
        continue;
      }
      const double expected_m = ground_.height_m(point.enu_m.head<2>());
      if (!std::isfinite(expected_m)) continue;
      problem.AddResidualBlock(cost<1, 3>(HeightError{expected_m, spread_m * share}), nullptr, point.enu_m.data());
    }
    problem.AddResidualBlock(
        cost<3, 3>(PriorError<3>{{0, block_.camera.distortion[0], block_.camera.distortion[1]},
                                 {block_.focal_length_sigma, block_.distortion_sigma, block_.distortion_sigma}}),
        nullptr, lens_.data());
  }

  void add_control_points(ceres::Problem& problem) {
    for (std::size_t i = 0; i < control_.size(); ++i) {
      for (const ControlPoint::Mark& mark : block_.control_points[i].marks) {
        const auto frame = static_cast<std::size_t>(mark.frame);
        problem.AddResidualBlock(
            cost<2, 6, 3, 3>(SightingError{&camera_, &camera_from_enu_[frame], mark.pixel, kMarkSigma_px}),
            new ceres::CauchyLoss(kPriorLoss), poses_[frame].data(), control_[i].data(), lens_.data());
      }
      problem.AddResidualBlock(
          cost<3, 3>(PriorError<3>{block_.control_points[i].enu_m, Eigen::Vector3d::Constant(block_.control_sigma_m)}),
          nullptr, control_[i].data());
    }
  }

  void add_reference_ties(ceres::Problem& problem) {
    for (std::size_t i = 0; i < ties_.size(); ++i) {
      const ReferenceTie& tie = block_.reference_ties[i];
      const auto frame = static_cast<std::size_t>(tie.frame);
      problem.AddResidualBlock(
          cost<2, 6, 3, 3>(SightingError{&camera_, &camera_from_enu_[frame], tie.pixel, kMarkSigma_px}),
          new ceres::CauchyLoss(kPriorLoss), poses_[frame].data(), ties_[i].data(), lens_.data());
      if (ground_.height_m) {
        problem.AddResidualBlock(
            cost<1, 3>(HeightError{tie.enu_m.z(), std::hypot(ground_.sigma_m, block_.surface_sigma_m)}), nullptr,
            ties_[i].data());
      } else {
        problem.AddResidualBlock(cost<1, 3, 3>(PlaneError{tie.above_plane_m, block_.surface_sigma_m}), nullptr,
                                 ties_[i].data(), plane_.data());
      }
      problem.AddResidualBlock(cost<2, 3, 2>(ReferenceError{tie.reference_en_m, tie.sigma_m}),
                               new ceres::CauchyLoss(kPriorLoss), ties_[i].data(), reference_bias_.data());
    }
    problem.AddResidualBlock(cost<2, 2>(PriorError<2>{{0, 0}, Eigen::Vector2d::Constant(block_.reference_sigma_m)}),
                             nullptr, reference_bias_.data());
  }

  void sum_errors(AdjustedBlock& done) const {
    std::vector<double> squares(poses_.size(), 0);
    done.frame_sightings.assign(poses_.size(), 0);
    double sum = 0;
    for (const AdjustedPoint& point : points_) {
      for (const Sighting& one : point.sightings) {
        const double square = error_px(point, one).squaredNorm();
        sum += square;
        squares[static_cast<std::size_t>(one.frame)] += square;
        ++done.frame_sightings[static_cast<std::size_t>(one.frame)];
        ++done.sightings;
      }
    }
    done.reprojection_rms_px = std::sqrt(sum / static_cast<double>(done.sightings));
    for (std::size_t i = 0; i < squares.size(); ++i) {
      done.frame_rms_px.push_back(done.frame_sightings[i] > 0 ? std::sqrt(squares[i] / done.frame_sightings[i]) : kNaN);
    }
  }

  const Block& block_;
  const GroundPrior& ground_;
  Camera camera_;
  std::array<double, 3> lens_;  ///< Log of the focal length's factor, k1, k2.
  std::vector<Eigen::Matrix3d> camera_from_enu_;
  std::vector<PoseBlock> poses_;
  std::vector<AdjustedPoint> points_;
  std::vector<Eigen::Vector3d> control_;
  std::vector<Eigen::Vector3d> ties_;
  std::array<double, 3> bias_{0, 0, 0};
  std::array<double, 3> boresight_{0, 0, 0};
  std::array<double, 3> plane_{0, 0, 0};
  std::array<double, 2> reference_bias_{0, 0};
  double clock_ = 0;
  bool converged_ = false;
  bool has_velocity_ = false;
  std::int64_t sightings_before_ = 0;
};

}  // namespace

AdjustedBlock adjust_block(const Block& block, const BlockStart& start, const std::vector<Track>& tracks,
                           const GroundPrior& ground, int threads, const Progress& progress) {
  Adjustment adjustment(block, start, tracks, ground);
  if (adjustment.sightings() < kFewestSightings) throw DataError("the frames have too little in common to be adjusted");
  adjustment.solve(0, progress);
  adjustment.drop_outliers();
  if (adjustment.sightings() < kFewestSightings) {
    throw DataError("the frames do not fit together: hardly a point is seen where it should be; is the camera right?");
  }
  adjustment.solve(1, progress);
  adjustment.drop_outliers();
  return adjustment.result(threads, progress);
}

}  // namespace pilotage
