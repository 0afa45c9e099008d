#pragma once

#include <optional>
#include <string>

#include "pilotage/base/options.h"
#include "pilotage/camera/camera_options.h"
#include "pilotage/registration/registration_options.h"

#pragma GCC visibility push(default)

namespace pilotage {

/// How a map is made of frames.
struct CaptureOptions {
  CameraOptions camera;
  double position_sigma_m = 3;
  double position_bias_sigma_m = 5;
  double height_sigma_m = 5;
  double tilt_sigma_deg = 3;
  double heading_sigma_deg = 5;
  std::string elevation;
  std::string control_points;
  double control_sigma_m = 0.05;
  std::string check_points;
  std::string align;
  std::optional<double> align_sigma_m;
  double min_compared = 0.5;
  RegistrationOptions registration;
  std::optional<double> gsd_m;
  std::string crs;
  bool leave_out = false;
  std::string matches;

  template <class Self, class Fields>
  static void describe(Self& self, Fields& fields) {
    fields.group("camera", self.camera, "The camera that took the frames; what their EXIF says, if not given.");
    fields.field("position_sigma_m", self.position_sigma_m,
                 "Standard deviation of the frames' positions, east and north each, where a table does not say it.",
                 Range{0.001, 100});
    fields.field("position_bias_sigma_m", self.position_bias_sigma_m,
                 "Standard deviation of what all positions miss alike, east and north each: the receiver's own error.",
                 Range{0.001, 100});
    fields.field("height_sigma_m", self.height_sigma_m, "Standard deviation of the frames' heights.",
                 Range{0.001, 100});
    fields.field("tilt_sigma_deg", self.tilt_sigma_deg,
                 "Standard deviation of pitch and roll as the frames have them; of frames that have none, three times "
                 "that from straight down.",
                 Range{0.01, 30});
    fields.field("heading_sigma_deg", self.heading_sigma_deg, "Standard deviation of the heading as frames have it.",
                 Range{0.01, 180});
    fields.path("elevation", self.elevation,
                "Elevation model of the ground: a GDAL dataset, metres; else a smooth surface through what the frames "
                "see.");
    fields.path("control_points", self.control_points,
                "Ground control points as OpenDroneMap's gcp_list.txt: a CRS, then lines of x y z, pixel, file.");
    fields.field("control_sigma_m", self.control_sigma_m, "Standard deviation of the control points, each axis.",
                 Range{0.001, 100});
    fields.path("check_points", self.check_points,
                "Surveyed points that take no part in the adjustment, against which the map is measured; as "
                "control_points.");
    fields.path("align", self.align,
                "Another map of this ground, an older one or a satellite's (GDAL dataset): ties this one to it.");
    fields.field("align_sigma_m", self.align_sigma_m,
                 "Standard deviation of how far that map lies off, each axis; what it says of its own error if not "
                 "given, or 1 m where it says nothing, with what its control points and datum add.",
                 Range{0.001, 100});
    fields.field("min_compared", self.min_compared,
                 "Share of the ground that both maps show that must be compared, or nothing is tied.", Range{0, 1});
    fields.group("registration", self.registration, "How the map is tied to that of align.");
    fields.field("gsd_m", self.gsd_m, "Ground sample distance of the map; that of the frames, if not given.",
                 Range{0.001, 100});
    fields.field("crs", self.crs, "CRS of the map, projected in metres; chosen if not given.");
    fields.field("leave_out", self.leave_out,
                 "Leave out frames that cannot be used, and name them, instead of ending with an error.");
    fields.path(
        "matches", self.matches,
        "Folder in which features of frames and matches of pairs are kept as they are found, and from which those "
        "that are there are taken: a run that was stopped goes on from there. Made when it is missing.");
  }
};

}  // namespace pilotage

#pragma GCC visibility pop
