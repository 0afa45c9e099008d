#pragma once

#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "pilotage/flightlog/flight_frames.h"
#include "pilotage/flightlog/frame_match.h"
#include "pilotage/geo/geodetic_point.h"

namespace pilotage {

/// How the place of a frame is known.
enum class PlaceSource { kTruth, kFix, kBetweenFixes, kPrior, kNone };

/// An inertial position minus what the frame alone says, east and north.
struct InertialError {
  Eigen::Vector2d error_m = Eigen::Vector2d::Zero();
  Eigen::Matrix2d covariance_m2 = Eigen::Matrix2d::Zero();  ///< Of what the frame says.
};

/// A frame of a flight that was flown, whatever said what became of it.
struct ReplayedFrame {
  std::string file;
  double time_s = std::numeric_limits<double>::quiet_NaN();
  std::string status;  ///< As fixes.csv has it.
  Outcome outcome = Outcome::kNotTried;
  GeodeticPoint place;  ///< Where it was taken; meaningless for kNone.
  PlaceSource place_from = PlaceSource::kNone;
  double height_agl_m = std::numeric_limits<double>::quiet_NaN();
  double yaw_deg = std::numeric_limits<double>::quiet_NaN();
  double error_m = std::numeric_limits<double>::quiet_NaN();  ///< Of the fix, where the truth is known.
  double nees = std::numeric_limits<double>::quiet_NaN();
  double prior_sigma_m = std::numeric_limits<double>::quiet_NaN();  ///< Largest, of what it was matched with.
  /// Of the position after the frame, that of the fix or else the one it was matched with: the largest standard
  /// deviation that is believed, and how far it is from the truth; NaN where that is not known.
  double navigated_sigma_m = std::numeric_limits<double>::quiet_NaN();
  double navigated_error_m = std::numeric_limits<double>::quiet_NaN();
  std::size_t map_count = 1;           ///< Maps that were asked.
  std::optional<GeodeticPoint> prior;  ///< What the inertial system said.
  std::optional<InertialError> inertial_error;

  bool is_tried() const { return outcome != Outcome::kNotTried; }
  bool has_fix() const { return is_tried() && outcome != Outcome::kRefused; }
  /// A right fix, or one that nobody can judge: false ones are one in a thousand.
  bool counts_as_right() const { return outcome == Outcome::kCorrect || outcome == Outcome::kUnjudged; }
};

/// The frames of one flight in the order of their times, one second or more apart or not.
struct ReplayedFlight {
  std::string name;
  std::vector<ReplayedFrame> frames;
  std::string priors;  ///< "inertial", "drawn", "autopilot" or "none": what ReplayedFrame::prior is.
  std::vector<std::string> notes;
};

/// Whether the matcher was asked at all: it was not for a status that says that there was nothing to match.
bool is_tried_status(const std::string& status);

/// The frames that were matched. `rows` are those before matching, whose priors no track has narrowed.
std::vector<ReplayedFrame> replayed_frames(std::span<const FrameMatch> matches, std::span<const FlightFrame> rows,
                                           double correct_within_m);

/// The frames of a table of fixes (schemas/fixes-csv.md) that was written before; of its columns `file`, `time_s` and
/// `status` are needed. A frame without a fix has its place between those of the fixes around it, at most 60 s away,
/// unless `rows` (frames.csv) say its prior and truth. Throws DataError naming `name`, line and column.
std::vector<ReplayedFrame> frames_of_fix_table(const std::string& name, std::string_view text,
                                               std::span<const FrameRecord> rows, double correct_within_m);

}  // namespace pilotage
