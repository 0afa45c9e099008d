#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "pilotage/base/options.h"
#include "pilotage/base/progress.h"
#include "pilotage/camera/camera.h"
#include "pilotage/ins/ins_error_model.h"
#include "pilotage/mission/frame_table.h"
#include "pilotage/vehiclelog/vehicle_log.h"

namespace pilotage {

/// What a frame of a log is matched with.
enum class LogPriors {
  kDrawn,  ///< The truth, off by a drawn error of an inertial system that drifts from the first frame on.
  kLog,    ///< The autopilot's own position.
};
inline EnumNames<LogPriors> enum_names(LogPriors) {
  return {{LogPriors::kDrawn, "drawn"}, {LogPriors::kLog, "log"}};
}

struct LogFrameOptions {
  LogPriors priors = LogPriors::kDrawn;
  double prior_sigma_m = 30;                 ///< Of LogPriors::kLog.
  std::optional<double> ground_amsl_m;       ///< Height of the ground where the log says no height above it …
  std::string elevation;                     ///< … else this elevation model, the plan's ("": none) …
  std::optional<double> flat_ground_amsl_m;  ///< … else the flat ground that the plan assumed.
  double every_s = 2;                        ///< Between rendered frames of a log without captures.
};

/// The frames of a log, where each was taken, and what of it is not known.
struct LogFrames {
  std::vector<FrameRecord> rows;  ///< Truth: the ground below the aircraft.
  std::vector<double> true_agl_m;
  std::vector<Attitude> true_attitude;
  std::vector<std::string> notes;
};

/// A frame for each capture of the log that has a position and an attitude within 1 s (2 s for positions of GNSS);
/// those without are left out with a note. Where the log has none and `make_up` is set, every
/// LogFrameOptions::every_s along the track. The truth is the simulator's, else GNSS; the height above ground the
/// capture's, else the range finder's, else the log's own; else the height above sea level less ground_amsl_m, less the
/// elevation model's below, less flat_ground_amsl_m, or less the lowest height of the log; a note says how many are of
/// which. Throws DataError when no frame is left, and when there is no truth to draw priors from;
/// UsageError as drifting_priors.
LogFrames frames_of_log(const VehicleLog& log, const LogFrameOptions& options, const InsErrorModel& model, bool make_up,
                        std::uint64_t seed);

/// Gives rows with a truth the priors of an inertial system whose errors are drawn, at the flight's mean speed. Throws
/// DataError for a row without truth, UsageError as drifting_priors.
void draw_priors(std::vector<FrameRecord>& rows, const InsErrorModel& model, std::uint64_t seed);

/// A picture of a folder, and when it was taken by its EXIF (seconds, of whatever clock the camera had).
struct Photo {
  std::string file;
  std::optional<double> taken_s;
};

/// The pictures (jpg, jpeg, png, tif, tiff, pgm) of a folder, by name, numbers in names as numbers: 9 before 10. Throws
/// DataError when there are none.
std::vector<Photo> photos_of_folder(const std::filesystem::path& folder);

/// Which photo is of which capture.
struct PhotoPairs {
  std::vector<std::optional<std::size_t>> photo_of_capture;
  std::string how;  ///< A sentence: by time with which difference and what was left over, or by order.
};

/// By time, where all photos have one, with a constant difference of the two clocks, and photos within 1 s of their
/// captures: where the log's UTC is known, whole quarters of an hour (a time zone) if at least half of the smaller list
/// finds a partner so; else the difference with which most do. Captures at regular intervals have a second reading
/// then, which is said. Else by order, where there are as many photos as captures. Throws DataError when neither is
/// possible.
PhotoPairs pair_photos(const std::vector<LoggedCapture>& captures, const std::vector<Photo>& photos,
                       std::optional<double> utc_minus_log_s);

/// Renders what `camera` saw of the ground in the raster `imagery` at the true poses, over the heights of `elevation`
/// or, where that is "", over flat ground, as PNG files in `folder`, and leaves out frames that imagery or heights do
/// not cover (with a note). The height above ground is the log's, which is also the one that is told, so what the
/// frames say of heights says nothing of the log's. Throws DataError as open_gray and Elevation, and when not one frame
/// is covered.
void render_log_frames(LogFrames& frames, const Camera& camera, const std::string& imagery,
                       const std::string& elevation, const std::filesystem::path& folder, int threads,
                       const Progress& progress);

}  // namespace pilotage
