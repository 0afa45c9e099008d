#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "pilotage/base/options.h"
#include "pilotage/camera/attitude.h"
#include "pilotage/geo/geodetic_point.h"
#include "pilotage/geo/position_covariance.h"

namespace pilotage {

/// Which point is known of a frame with truth.
enum class FrameTruth {
  kCenter,  ///< The ground that the camera's principal point shows.
  kNadir,   ///< The ground straight below the aircraft.
};

inline EnumNames<FrameTruth> enum_names(FrameTruth) {
  return {{FrameTruth::kCenter, "center"}, {FrameTruth::kNadir, "nadir"}};
}

/// A frame of a logged flight, what the aircraft believed when it was taken, and where it really was: one row of
/// frames.csv (schemas/frames-csv.md). NaN where the table says nothing.
struct FrameRecord {
  std::string file;  ///< As in the table: relative to the table's folder.
  double time_s = 0;
  GeodeticPoint prior;  ///< Of the aircraft.
  /// Of the prior: variances of east and north and their covariance.
  Eigen::Matrix2d prior_covariance_en_m2 = Eigen::Matrix2d::Zero();
  double height_agl_m = 0;
  Attitude attitude;
  std::optional<GeodeticPoint> true_nadir;
  std::optional<GeodeticPoint> true_center;

  /// What an answer is judged by: the aircraft's own place, which a flight is steered by; where only the centre of the
  /// image is known, that.
  const std::optional<GeodeticPoint>& truth() const { return true_nadir ? true_nadir : true_center; }
};

struct FrameTable {
  std::vector<FrameRecord> frames;    ///< In the order of the table.
  std::vector<std::string> warnings;  ///< Columns that are not known, with the known one they may stand for.
};

/// What must stand in the table besides `file`.
enum class FrameColumns {
  kAll,       ///< time_s, the prior and the attitude, in every row.
  kFileOnly,  ///< Nothing: the rest may be missing or empty (it comes from the frames themselves).
};

struct FrameTableOptions {
  /// What true_lon_deg and true_lat_deg are in a table without true_nadir_lon_deg and true_nadir_lat_deg; beside these
  /// they are the centre.
  FrameTruth truth = FrameTruth::kCenter;
  FrameColumns required = FrameColumns::kAll;
};

/// Reads frames.csv. Columns by name, in any order; CRLF, quotes and a byte order mark are allowed; unknown columns are
/// left out with a warning (true_yaw_deg, true_pitch_deg, true_roll_deg and true_height_agl_m without one). Truth may
/// be missing as a column or empty in a row, but only both of its coordinates. Throws DataError naming `name`, line,
/// column, value and what is allowed: for a column that is missing or stands twice, a row with another number of cells,
/// an empty file name, a cell that is empty or no number, or a number outside its range (longitude [−180, 360],
/// latitude [−90, 90], angles [−360, 360], sigmas of the prior [0, 100000], height_agl_m [−1000, 100000], time_s
/// finite), and for a table without a row. How sure the prior is stands either in prior_sigma_m or in
/// prior_east_sigma_m, prior_north_sigma_m and prior_covariance_en_m2: both, a part of the latter, and a covariance
/// larger than the product of its sigmas are errors, too.
FrameTable frame_table_from_csv(const std::string& name, std::string_view text, const FrameTableOptions& options = {});

/// The covariance of a prior from its three columns; NaN where one is. Throws UsageError when the covariance is larger
/// than the product of the standard deviations.
Eigen::Matrix2d prior_covariance(double east_sigma_m, double north_sigma_m, double covariance_en_m2);

/// The file of a frame as it is to be opened: a relative one in the folder of the table.
std::string frame_path(const std::string& table_path, const std::string& file);

}  // namespace pilotage
