#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "pilotage/capture/capture_options.h"
#include "pilotage/flightlog/flight_frames.h"
#include "pilotage/geo/local_frame.h"

namespace pilotage {

/// What the heights of frames are counted from.
enum class FrameHeights {
  kTakeOff,  ///< The place of take-off, or whatever height_agl_m of the table meant.
  kAmsl,     ///< Mean sea level, as the receiver gave it.
};

/// The frames of which a map is made.
struct CaptureFrames {
  std::vector<FlightFrame> frames;
  std::vector<double> heights_m;  ///< Of each frame.
  FrameHeights heights = FrameHeights::kTakeOff;
  Camera camera;              ///< Of all of them.
  std::string camera_source;  ///< Where it comes from, as a word for people.
  bool camera_is_given = false;
  std::vector<double> taken_s;        ///< By the camera's clock, or the table's; NaN where not known.
  std::vector<std::string> left_out;  ///< "path: why".
  std::vector<std::string> notes;
};

/// Reads what tables and pictures say: `inputs` are one frames.csv (schemas/frames-csv.md; empty cells are filled from
/// the pictures), folders of pictures, or pictures. No pixel is read. Throws UsageError for a camera that is not fully
/// described; DataError, naming the frames, for those without position, height or camera, of different cameras or
/// taken more than kMostDaysApart days apart (where CaptureOptions::leave_out is set, the former are left out),
/// and when fewer than three frames remain or all are of one place.
CaptureFrames read_capture_frames(const std::vector<std::string>& inputs, const CaptureOptions& options);

/// Around the median of the positions, which one that is wrong does not move.
LocalFrame local_frame(const CaptureFrames& frames);

/// The ground below each frame, as its position has it.
std::vector<Eigen::Vector2d> nadirs_en_m(const CaptureFrames& frames, const LocalFrame& local);

/// A map shows one date.
inline constexpr double kMostDaysApart = 30;

/// Takes the frames at the ascending `numbers` alone.
void keep_frames(CaptureFrames& frames, const std::vector<int>& numbers);

/// Frames that cannot be used, "path: why" each: DataError with the first twelve and `in_all`, which sums them up, or,
/// with `leave_out`, into CaptureFrames::left_out.
void refuse_frames(const std::vector<std::string>& problems, bool leave_out, CaptureFrames& frames,
                   const std::string& in_all = "");

}  // namespace pilotage
