#include "pilotage/capture/frame_errors.h"

#include <algorithm>
#include <map>
#include <mutex>
#include <utility>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/SparseCholesky>

#include "pilotage/base/error.h"
#include "pilotage/base/parallel.h"

namespace pilotage {
namespace {

constexpr int kPose = 6;
constexpr int kLens = 3;
constexpr int kPlane = 3;

/// Slopes of the ground below a frame, one standard deviation, before any point is seen: for points in one line.
constexpr double kSteepestGround = 0.3;
/// A direction of which a point says so much less than of its best is taken for as well known: two rays in one line.
constexpr double kLeastKnown = 1e-10;

/// How a point follows the frames and what they share: its displacement is along · d(columns) + noise.
struct PointMotion {
  std::vector<int> columns;
  Eigen::Matrix<double, 3, Eigen::Dynamic> along;
  Eigen::Matrix3d noise_m2 = Eigen::Matrix3d::Zero();
};

/// The normal equations of frames and shared parameters, without the points.
class ReducedNormal {
 public:
  ReducedNormal(int frames, int shared) : frames_(frames), shared_(shared) {}

  int size() const { return kPose * frames_ + shared_; }

  /// `matrix` over ascending `columns`, of which each frame has all or none.
  void add(const std::vector<int>& columns, const Eigen::MatrixXd& matrix) {
    std::vector<std::pair<int, int>> parts;  // block, first place
    for (std::size_t i = 0; i < columns.size(); ++i) {
      if (i == 0 || block_of(columns[i]) != block_of(columns[i - 1])) {
        parts.emplace_back(block_of(columns[i]), static_cast<int>(i));
      }
    }
    const auto end_of = [&](std::size_t part) {
      return part + 1 < parts.size() ? parts[part + 1].second : static_cast<int>(columns.size());
    };
    for (std::size_t a = 0; a < parts.size(); ++a) {
      for (std::size_t b = 0; b <= a; ++b) {
        const auto [row_block, row] = parts[a];
        const auto [col_block, col] = parts[b];
        Eigen::MatrixXd& sum = blocks_[{row_block, col_block}];
        if (sum.size() == 0) sum = Eigen::MatrixXd::Zero(size_of(row_block), size_of(col_block));
        for (int i = row; i < end_of(a); ++i) {
          for (int j = col; j < end_of(b); ++j) {
            sum(columns[static_cast<std::size_t>(i)] - first_of(row_block),
                columns[static_cast<std::size_t>(j)] - first_of(col_block)) += matrix(i, j);
          }
        }
      }
    }
  }

  Eigen::SparseMatrix<double> lower() const {
    std::vector<Eigen::Triplet<double>> values;
    for (const auto& [place, block] : blocks_) {
      for (int i = 0; i < block.rows(); ++i) {
        for (int j = 0; j < block.cols(); ++j) {
          const int row = first_of(place.first) + i;
          const int col = first_of(place.second) + j;
          if (row >= col && block(i, j) != 0) values.emplace_back(row, col, block(i, j));
        }
      }
    }
    Eigen::SparseMatrix<double> matrix(size(), size());
    matrix.setFromTriplets(values.begin(), values.end());
    return matrix;
  }

 private:
  int block_of(int column) const { return std::min(column / kPose, frames_); }
  int first_of(int block) const { return kPose * block; }
  int size_of(int block) const { return block < frames_ ? kPose : shared_; }

  int frames_;
  int shared_;
  std::map<std::pair<int, int>, Eigen::MatrixXd> blocks_;  // of the lower half
};

/// Adds some rows of the Jacobian, which see one point (its first column; −1: none), to the normal equations, and
/// eliminates it.
PointMotion add_rows(const ceres::CRSMatrix& jacobian, const std::vector<int>& rows, int point_column,
                     ReducedNormal& normal) {
  PointMotion point;
  const auto for_each = [&](const auto& use) {
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const auto row = static_cast<std::size_t>(rows[i]);
      for (int k = jacobian.rows[row]; k < jacobian.rows[row + 1]; ++k) {
        const auto at = static_cast<std::size_t>(k);
        use(static_cast<int>(i), jacobian.cols[at], jacobian.values[at]);
      }
    }
  };
  for_each([&](int /*row*/, int column, double /*value*/) {
    if (column < normal.size()) point.columns.push_back(column);
  });
  std::sort(point.columns.begin(), point.columns.end());
  point.columns.erase(std::unique(point.columns.begin(), point.columns.end()), point.columns.end());
  const auto count = static_cast<int>(rows.size());
  Eigen::MatrixXd of_frames = Eigen::MatrixXd::Zero(count, static_cast<int>(point.columns.size()));
  Eigen::MatrixXd of_point = Eigen::MatrixXd::Zero(count, 3);
  for_each([&](int row, int column, double value) {
    if (column < normal.size()) {
      const auto place = std::lower_bound(point.columns.begin(), point.columns.end(), column) - point.columns.begin();
      of_frames(row, place) = value;
    } else {
      of_point(row, column - point_column) = value;
    }
  });
  if (point_column < 0) {
    normal.add(point.columns, of_frames.transpose() * of_frames);
    return point;
  }
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> own;
  own.computeDirect(of_point.transpose() * of_point);
  const Eigen::Vector3d known = own.eigenvalues().cwiseMax(kLeastKnown * own.eigenvalues().maxCoeff());
  const Eigen::Matrix3d covariance =
      own.eigenvectors() * known.cwiseInverse().asDiagonal() * own.eigenvectors().transpose();
  const Eigen::MatrixXd between = of_frames.transpose() * of_point;
  normal.add(point.columns, of_frames.transpose() * of_frames - between * covariance * between.transpose());
  point.along = -covariance * between.transpose();
  point.noise_m2 = covariance;
  return point;
}

/// Errors of the plane through points: of its height (below the camera) and slopes, 3 rows.
struct GroundBelow {
  Eigen::RowVector2d slope;  ///< Of the plane itself.
  Eigen::MatrixXd along;     ///< 3 × columns of the normal equations.
  Eigen::Matrix3d noise = Eigen::Matrix3d::Zero();
};

GroundBelow plane_through(const Eigen::Vector3d& center_enu_m, const std::vector<std::size_t>& seen,
                          const std::vector<AdjustedPoint>& points, const std::vector<PointMotion>& motions, int size) {
  GroundBelow ground{{0, 0}, Eigen::MatrixXd::Zero(kPlane, size), Eigen::Matrix3d::Zero()};
  const Eigen::Matrix3d slopes = (Eigen::Vector3d(0, 1, 1) / (kSteepestGround * kSteepestGround)).asDiagonal();
  const auto row_of = [&](std::size_t i) {
    return Eigen::Vector3d(1, points[i].enu_m.x() - center_enu_m.x(), points[i].enu_m.y() - center_enu_m.y());
  };
  Eigen::Matrix3d seen_squares = slopes;
  Eigen::Vector3d seen_heights(0, 0, 0);
  for (const std::size_t i : seen) {
    seen_squares += row_of(i) * row_of(i).transpose();
    seen_heights += row_of(i) * points[i].enu_m.z();
  }
  ground.slope = seen_squares.ldlt().solve(seen_heights).tail<2>().transpose();
  // The height of the ground at one place changes, too, when points move along a slope.
  const Eigen::RowVector3d height_by_point(-ground.slope.x(), -ground.slope.y(), 1);
  const auto noise_of_m2 = [&](std::size_t i) {
    return (height_by_point * motions[i].noise_m2 * height_by_point.transpose()).value();
  };
  Eigen::Matrix3d weighed = slopes;
  Eigen::Matrix3d noise = slopes;
  double mean_noise_m2 = 0;
  for (const std::size_t i : seen) mean_noise_m2 += noise_of_m2(i) / static_cast<double>(seen.size());
  for (const std::size_t i : seen) {
    const double weight = 1 / (noise_of_m2(i) + mean_noise_m2);
    const Eigen::Vector3d row = row_of(i);
    weighed += weight * row * row.transpose();
    noise += weight * weight * noise_of_m2(i) * row * row.transpose();
    const Eigen::RowVectorXd along = height_by_point * motions[i].along;
    for (std::size_t k = 0; k < motions[i].columns.size(); ++k) {
      ground.along.col(motions[i].columns[k]) += weight * along(static_cast<int>(k)) * row;
    }
  }
  const Eigen::Matrix3d inverse = weighed.inverse();
  ground.along = inverse * ground.along;
  ground.noise = inverse * noise * inverse;
  return ground;
}

}  // namespace

std::vector<FrameError> frame_errors(const ceres::CRSMatrix& jacobian, int shared, const std::vector<FramePose>& poses,
                                     const std::vector<AdjustedPoint>& points, bool ground_of_points, int threads,
                                     const Progress& progress) {
  const auto frames = static_cast<int>(poses.size());
  ReducedNormal normal(frames, shared);
  const int first_point = normal.size();
  std::vector<std::vector<int>> rows_of(static_cast<std::size_t>((jacobian.num_cols - first_point) / 3));
  std::vector<PointMotion> motions;
  for (int row = 0; row < jacobian.num_rows; ++row) {
    const int last = jacobian.rows[static_cast<std::size_t>(row) + 1];
    int point = -1;
    for (int k = jacobian.rows[static_cast<std::size_t>(row)]; k < last; ++k) {
      const int column = jacobian.cols[static_cast<std::size_t>(k)];
      if (column >= first_point) point = (column - first_point) / 3;
    }
    if (point < 0) {
      add_rows(jacobian, {row}, -1, normal);
    } else {
      rows_of[static_cast<std::size_t>(point)].push_back(row);
    }
  }
  for (std::size_t i = 0; i < rows_of.size(); ++i) {
    motions.push_back(add_rows(jacobian, rows_of[i], first_point + 3 * static_cast<int>(i), normal));
  }
  const Eigen::SimplicialLLT<Eigen::SparseMatrix<double>, Eigen::Lower> factor(normal.lower());
  if (factor.info() != Eigen::Success) {
    throw DataError("the frames' positions and attitudes do not determine where the map lies");
  }

  std::vector<std::vector<std::size_t>> seen(poses.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (const Sighting& one : points[i].sightings) seen[static_cast<std::size_t>(one.frame)].push_back(i);
  }
  std::vector<FrameError> errors(poses.size());
  std::mutex reporting;
  std::int64_t done = 0;
  parallel_for(poses.size(), threads, [&](std::size_t number, int) {
    const int frame = static_cast<int>(number);
    Eigen::MatrixXd wanted = Eigen::MatrixXd::Zero(normal.size(), FrameError::kSize);
    wanted.block<kPose, kPose>(kPose * frame, 0).setIdentity();
    wanted.block<kLens, kLens>(kPose * frames, kPose).setIdentity();
    errors[number].covariance.setZero();
    if (ground_of_points && !seen[number].empty()) {
      const GroundBelow ground =
          plane_through(poses[number].center_enu_m, seen[number], points, motions, normal.size());
      wanted.rightCols<kPlane>() = ground.along.transpose();
      errors[number].covariance.bottomRightCorner<kPlane, kPlane>() = ground.noise;
      errors[number].ground_slope = ground.slope;
    }
    const Eigen::MatrixXd permuted = factor.permutationP() * wanted;
    const Eigen::MatrixXd half = factor.matrixL().solve(permuted);
    errors[number].covariance += half.transpose() * half;
    const std::lock_guard lock(reporting);
    report_progress(progress, "errors of the frames", ++done, frames);
  });
  return errors;
}

}  // namespace pilotage
