#include "pilotage/capture/capture_frames.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>

#include "pilotage/base/error.h"
#include "pilotage/base/nan.h"
#include "pilotage/base/read_file.h"
#include "pilotage/base/statistics.h"
#include "pilotage/base/text.h"
#include "pilotage/capture/ortho_mosaic.h"
#include "pilotage/geo/geodesic.h"

namespace pilotage {
namespace {

constexpr std::size_t kFewest = 3;
constexpr std::size_t kNamed = 12;
constexpr double kSecondsOfDay = 86400;
/// Two cameras, or two zooms of one.
constexpr double kSameFocalLength = 0.01;

FrameRecord empty_record(const std::string& file) {
  FrameRecord record;
  record.file = file;
  record.time_s = record.height_agl_m = kNaN;
  record.prior = {kNaN, kNaN};
  record.prior_covariance_en_m2.setConstant(kNaN);
  record.attitude = {kNaN, kNaN, kNaN};
  return record;
}

struct NamedRecord {
  std::string path;
  FrameRecord record;
};

std::vector<NamedRecord> named_records(const std::vector<std::string>& inputs, std::vector<std::string>& notes) {
  std::vector<NamedRecord> records;
  for (const std::string& input : inputs) {
    const std::filesystem::path path(input);
    std::error_code none;
    if (std::filesystem::is_directory(path, none)) {
      for (const std::string& name : pictures_of_folder(path)) {
        records.push_back({(path / name).string(), empty_record(name)});
      }
    } else if (path.extension() == ".csv") {
      if (inputs.size() > 1) throw UsageError(input + ": a table of frames stands alone; give nothing beside it");
      const FrameTable table =
          frame_table_from_csv(input, read_file(input), {FrameTruth::kCenter, FrameColumns::kFileOnly});
      notes.insert(notes.end(), table.warnings.begin(), table.warnings.end());
      for (const FrameRecord& frame : table.frames) records.push_back({frame_path(input, frame.file), frame});
    } else {
      records.push_back({input, empty_record(path.filename().string())});
    }
  }
  return records;
}

/// Height and time as a frame has them, NaN for what it has not.
struct FrameStatement {
  double above_take_off_m = kNaN;
  double amsl_m = kNaN;
  double taken_s = kNaN;
};

/// Which heights all frames have; those of the barometer before those of the receiver.
void choose_heights(const std::vector<FrameStatement>& said, CaptureFrames& frames,
                    std::vector<std::string>& problems) {
  const auto count = [&](double FrameStatement::*member) {
    return std::count_if(said.begin(), said.end(), [&](const FrameStatement& one) { return !std::isnan(one.*member); });
  };
  const bool by_take_off = count(&FrameStatement::above_take_off_m) >= count(&FrameStatement::amsl_m) &&
                           count(&FrameStatement::above_take_off_m) > 0;
  frames.heights = by_take_off ? FrameHeights::kTakeOff : FrameHeights::kAmsl;
  for (std::size_t i = 0; i < said.size(); ++i) {
    frames.heights_m.push_back(by_take_off ? said[i].above_take_off_m : said[i].amsl_m);
    if (std::isnan(frames.heights_m.back())) {
      problems.push_back(frames.frames[i].path + ": has no height" +
                         (by_take_off && !std::isnan(said[i].amsl_m) ? " above take-off, as most have" : ""));
    }
  }
}

std::string camera_words(const Camera& camera) {
  return std::to_string(camera.width_px) + " x " + std::to_string(camera.height_px) + " px, focal length " +
         format_fixed(camera.fx_px, 0) + " px";
}

bool same_camera(const Camera& a, const Camera& b) {
  return a.width_px == b.width_px && a.height_px == b.height_px && std::abs(a.fx_px / b.fx_px - 1) < kSameFocalLength;
}

/// The camera of most frames; the others cannot be used.
std::vector<int> frames_of_one_camera(CaptureFrames& frames, std::vector<std::string>& problems) {
  std::vector<int> most;
  for (const FlightFrame& first : frames.frames) {
    std::vector<int> alike;
    for (std::size_t i = 0; i < frames.frames.size(); ++i) {
      if (same_camera(first.camera, frames.frames[i].camera)) alike.push_back(static_cast<int>(i));
    }
    if (alike.size() > most.size()) most = std::move(alike);
    if (2 * most.size() > frames.frames.size()) break;
  }
  const FlightFrame& usual = frames.frames[static_cast<std::size_t>(most.front())];
  frames.camera = usual.camera;
  for (const FlightFrame& one : frames.frames) {
    if (same_camera(one.camera, frames.camera)) continue;
    problems.push_back(one.path + ": is of another camera (" + camera_words(one.camera) + ") than " + usual.path +
                       " (" + camera_words(frames.camera) + ")");
  }
  return most;
}

void refuse_dates_apart(const CaptureFrames& frames) {
  std::size_t first = 0;
  std::size_t last = 0;
  for (std::size_t i = 0; i < frames.taken_s.size(); ++i) {
    if (std::isnan(frames.taken_s[i])) continue;
    if (!(frames.taken_s[first] <= frames.taken_s[i])) first = i;
    if (!(frames.taken_s[last] >= frames.taken_s[i])) last = i;
  }
  const double days = (frames.taken_s[last] - frames.taken_s[first]) / kSecondsOfDay;
  if (!(days > kMostDaysApart)) return;
  throw DataError(frames.frames[first].path + " and " + frames.frames[last].path + ": were taken " +
                  format_fixed(days, 0) + " days apart; a map shows one date (at most " +
                  format_fixed(kMostDaysApart, 0) + " days): give each flight alone");
}

void refuse_one_place(const CaptureFrames& frames) {
  double extent_m = 0;
  for (const FlightFrame& one : frames.frames) {
    extent_m = std::max(extent_m, geodesic_between(frames.frames.front().frame.prior, one.frame.prior).length_m);
  }
  constexpr double kOnePlace_m = 1;
  if (extent_m < kOnePlace_m) {
    throw DataError("all " + std::to_string(frames.frames.size()) + " frames were taken at one place (within " +
                    format_fixed(extent_m, 2) + " m): nothing tells how high the camera was");
  }
}

}  // namespace

void refuse_frames(const std::vector<std::string>& problems, bool leave_out, CaptureFrames& frames,
                   const std::string& in_all) {
  if (problems.empty()) return;
  if (leave_out) {
    frames.left_out.insert(frames.left_out.end(), problems.begin(), problems.end());
    return;
  }
  std::vector<std::string> named(problems.begin(),
                                 problems.begin() + static_cast<std::ptrdiff_t>(std::min(kNamed, problems.size())));
  if (problems.size() > kNamed) named.push_back("and " + std::to_string(problems.size() - kNamed) + " more");
  throw DataError(join(named, "; ") + (in_all.empty() ? "" : "; " + in_all) +
                  ". Remove them, say in a table (frames.csv) what they lack, or give --leave-out");
}

LocalFrame local_frame(const CaptureFrames& frames) {
  const double reference_deg = frames.frames.front().frame.prior.lon_deg;
  std::vector<double> lons_deg;
  std::vector<double> lats_deg;
  for (const FlightFrame& one : frames.frames) {
    lons_deg.push_back(unwrap_lon_deg(one.frame.prior.lon_deg, reference_deg));
    lats_deg.push_back(one.frame.prior.lat_deg);
  }
  return LocalFrame({wrap_lon_deg(quantile(lons_deg, 0.5)), quantile(lats_deg, 0.5)});
}

std::vector<Eigen::Vector2d> nadirs_en_m(const CaptureFrames& frames, const LocalFrame& local) {
  std::vector<Eigen::Vector2d> nadirs;
  for (const FlightFrame& one : frames.frames) nadirs.push_back(east_north_m(local, one.frame.prior));
  return nadirs;
}

void keep_frames(CaptureFrames& frames, const std::vector<int>& numbers) {
  for (std::size_t to = 0; to < numbers.size(); ++to) {
    const auto from = static_cast<std::size_t>(numbers[to]);
    if (from == to) continue;
    frames.frames[to] = std::move(frames.frames[from]);
    frames.heights_m[to] = frames.heights_m[from];
    frames.taken_s[to] = frames.taken_s[from];
  }
  frames.frames.resize(numbers.size());
  frames.heights_m.resize(numbers.size());
  frames.taken_s.resize(numbers.size());
  if (numbers.size() < kFewest) {
    throw DataError(
        std::to_string(numbers.size()) + (numbers.size() == 1 ? " frame" : " frames") +
        (frames.left_out.empty() ? "" : " without those that cannot be used (" + frames.left_out.front() + ")") +
        ": a map needs at least " + std::to_string(kFewest) + " that overlap");
  }
}

CaptureFrames read_capture_frames(const std::vector<std::string>& inputs, const CaptureOptions& options) {
  CaptureFrames all;
  FrameSources sources;
  sources.from_exif = true;
  sources.exif_mount = {options.camera.mount_yaw_deg, options.camera.mount_pitch_deg, options.camera.mount_roll_deg};
  if (names_camera(options.camera)) sources.given = make_camera(options.camera);
  all.camera_is_given = sources.given.has_value();
  std::vector<std::string> problems;
  std::vector<FrameStatement> said;
  std::vector<std::string> camera_tags;
  for (const NamedRecord& named : named_records(inputs, all.notes)) {
    try {
      const FrameExif exif = frame_exif(read_image_metadata(named.path));
      const auto own = exif_camera(exif);
      if (!sources.given && !own) {
        throw DataError(named.path + ": its tags do not say what camera took it (no focal length); give --camera");
      }
      FlightFrames complete = complete_frame(named.path, named.record, sources);
      FlightFrame& one = complete.frames.front();
      if (sources.given) one.camera = camera_for_size(named.path, *sources.given, exif.width_px, exif.height_px);
      check_camera(named.path, one.camera);
      if (std::isnan(one.frame.prior.lon_deg) || std::isnan(one.frame.prior.lat_deg)) {
        throw DataError(named.path + ": has no position");
      }
      for (const std::string& warning : exif.warnings) all.notes.push_back(named.path + ": " + warning);
      const bool table_has_time = !std::isnan(named.record.time_s);
      said.push_back({one.frame.height_agl_m, exif.amsl_m ? exif.amsl_m->value : kNaN,
                      table_has_time ? named.record.time_s : exif.taken_s.value_or(kNaN)});
      camera_tags.push_back(sources.given ? "as given" : own->tag);
      all.frames.push_back(std::move(one));
    } catch (const DataError& error) {
      problems.emplace_back(error.what());
    }
  }
  refuse_frames(problems, options.leave_out, all);
  problems.clear();
  choose_heights(said, all, problems);
  for (const FrameStatement& one : said) all.taken_s.push_back(one.taken_s);
  refuse_frames(problems, options.leave_out, all);
  std::vector<int> usable;
  for (std::size_t i = 0; i < all.frames.size(); ++i) {
    if (!std::isnan(all.heights_m[i])) usable.push_back(static_cast<int>(i));
  }
  keep_frames(all, usable);
  problems.clear();
  const std::vector<int> of_one_camera = frames_of_one_camera(all, problems);
  all.camera_source = camera_tags[static_cast<std::size_t>(usable[static_cast<std::size_t>(of_one_camera.front())])];
  refuse_frames(problems, options.leave_out, all);
  keep_frames(all, of_one_camera);
  if (all.camera.distortion_model == DistortionModel::kFisheye) {
    throw UsageError(
        "a fisheye camera cannot be adjusted: undistort its frames, and give the camera of what that gives");
  }
  refuse_dates_apart(all);
  refuse_one_place(all);
  return all;
}

}  // namespace pilotage
