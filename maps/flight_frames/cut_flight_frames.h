#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "pilotage/base/options.h"
#include "pilotage/ins/ins_options.h"
#include "pilotage/raster/gdal_imagery.h"

namespace pilotage {

enum class FrameFormat { kJpg, kPng, kPgm };
inline EnumNames<FrameFormat> enum_names(FrameFormat) {
  return {{FrameFormat::kJpg, "jpg"}, {FrameFormat::kPng, "png"}, {FrameFormat::kPgm, "pgm"}};
}

/// How frames are cut. Ranges and meanings: describe().
struct FlightFrameOptions {
  int frames = 500;
  double footprint_m = 154;
  double hfov_deg = 60;
  std::optional<int> width_px;
  std::optional<int> height_px;
  std::string camera;
  double max_tilt_deg = 5;
  double attitude_sigma_deg = 1;
  double height_sigma = 0.03;
  double prior_offset_m = 60;
  double prior_shift_m = 0;
  double prior_sigma_m = 30;
  bool prior_drifts = false;
  double speed_mps = 20;
  InsOptions ins;
  double min_valid = 0.999;
  std::string also;
  std::vector<double> region;
  std::string route;
  std::string elevation;
  FrameFormat format = FrameFormat::kJpg;
  ImageryOptions imagery;

  template <class Self, class Fields>
  static void describe(Self& self, Fields& fields) {
    fields.field("frames", self.frames, "How many.", Range{1, 1e6});
    fields.field("footprint_m", self.footprint_m, "Width on the ground of a frame taken straight down.",
                 Range{0.1, 1e5});
    fields.field("hfov_deg", self.hfov_deg, "Horizontal field of view of the ideal camera.", Range{1, 170});
    fields.field("width_px", self.width_px, "Width of a frame: 640, or that of the calibration file.", Range{1, 10000});
    fields.field("height_px", self.height_px, "Height of a frame: 480, or that of the calibration file.",
                 Range{1, 10000});
    fields.path("camera", self.camera, "A calibration file instead of the ideal camera.");
    fields.field("max_tilt_deg", self.max_tilt_deg, "Largest angle of the belly from straight down.", Range{0, 45});
    fields.field("attitude_sigma_deg", self.attitude_sigma_deg,
                 "Standard deviation of the error of yaw, pitch and roll each.", Range{0, 180});
    fields.field("height_sigma", self.height_sigma, "Standard deviation of the height's error, as a share of it.",
                 Range{0, 0.3});
    fields.field("prior_offset_m", self.prior_offset_m,
                 "The prior is off by at most this to the east and to the north, uniformly.", Range{0, 1e5});
    fields.field("prior_shift_m", self.prior_shift_m,
                 "The prior is off by this besides, in any direction: beyond the window nothing may be found.",
                 Range{0, 1e6});
    fields.field("prior_sigma_m", self.prior_sigma_m, "What the prior says of itself.", Range{0.01, 1e5});
    fields.field("prior_drifts", self.prior_drifts,
                 "The priors are those of one inertial system (--ins-...) that flies the route: one error that drifts, "
                 "with the covariance of its error model, instead of errors by themselves. The shift is one for all.");
    fields.field("speed_mps", self.speed_mps, "Along the route, with --prior-drifts.", Range{0.1, 1000});
    fields.group("ins", self.ins, "The inertial system of --prior-drifts.");
    fields.field("min_valid", self.min_valid, "Least share of a frame that shows imagery.", Range{0, 1});
    fields.path("also", self.also,
                "A second raster, the map's: frames are only where it shows ground all over the frame too.");
    fields.field("region", self.region,
                 "min x, min y, max x, max y in the raster's CRS: where the aircraft is. Default: everywhere.");
    fields.path(
        "route", self.route,
        "Fly along this route: frames at equal distances, the nose along the leg. Default: any place and heading.");
    fields.path(
        "elevation", self.elevation,
        "Lay the imagery over this elevation model: frames show its parallax, and the aircraft is as high above "
        "the ground straight below it everywhere. Default: level ground.");
    fields.field("format", self.format, "Of the frames; jpg has quality 95.");
    fields.group("imagery", self.imagery, "How the raster is read.", FlagPrefix::kNone);
  }
};

/// Camera frames of a flight that never was, cut from georeferenced imagery (a GDAL dataset), with the truth beside
/// what the aircraft believes. Writes camera.yaml, frames.csv (schemas/frames-csv.md) and the frames into `folder`,
/// which is made when it is missing. Everything about a frame comes from the seed and the frame's number, not from the
/// number of threads. Returns the height above ground, in metres, at which a frame is as wide as was asked for. Throws
/// UsageError for options that contradict each other, DataError when imagery, route or calibration cannot be read, when
/// a file exists and `overwrite` is false, or when a frame finds no place that shows imagery all over (and, with
/// an elevation model, heights).
double cut_flight_frames(const std::string& imagery, const std::filesystem::path& folder,
                         const FlightFrameOptions& options, std::uint64_t seed, int threads, bool overwrite);

}  // namespace pilotage
