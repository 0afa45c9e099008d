#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "course.h"
#include "locate_rings.h"
#include "ring_field.h"
#include "ring_scene.h"

#include "pilotage/base/options.h"
#include "pilotage/ins/ins_options.h"
#include "pilotage/mapdb/map_reader.h"

namespace pilotage {

/// What flies, and over what. Ranges and meanings: describe().
struct RingFlightOptions {
  RingSceneOptions scene;
  double speed_mps = 3.5;
  double scan_speed_mps = 5;
  double fix_interval_s = 1;
  double half_span_m = 0.35;
  double camera_noise = 3;
  InsOptions ins;

  template <class Self, class Fields>
  static void describe(Self& self, Fields& fields) {
    RingSceneOptions::describe(self.scene, fields);
    fields.field("speed_mps", self.speed_mps, "Through the rings.", Range{1, 6});
    fields.field("scan_speed_mps", self.scan_speed_mps, "Around the field.", Range{2, 8});
    fields.field("fix_interval_s", self.fix_interval_s, "Time between two frames of the camera that looks down.",
                 Range{0.2, 30});
    fields.field("half_span_m", self.half_span_m, "From the middle of the aircraft to its tips.", Range{0.05, 1});
    fields.field("camera_noise", self.camera_noise, "Noise of a pixel, one standard deviation, of 255.", Range{0, 30});
    fields.group("ins", self.ins, "The inertial system; consumer if neither grade nor name is given.");
  }
};

/// Heights that the map of the field is prepared for; rings stand between them, the scan flies at the upper one.
inline constexpr double kLowest_m = 5;
inline constexpr double kScanHeight_m = 10;

/// The camera for the matcher, straight down, and the one that looks for rings, 20° below the horizon.
Camera down_camera();
Camera forward_camera();

/// What became of the frames that looked down.
struct FixCounts {
  int frames = 0;
  int fixes = 0;                ///< The matcher's.
  int taken = 0;                ///< By the navigation filter, resets included.
  int refused = 0;              ///< By its gate.
  double squared_error_m2 = 0;  ///< Of the fixes against the truth, summed.
};

/// How an element of the array stands to the truth.
struct JudgedRing {
  LocatedRing ring;
  int truth = -1;      ///< Index of RingScene::rings, −1: false.
  double error_m = 0;  ///< Of the center, three-dimensional; with `truth` those below too.
  double nees = 0;     ///< Squared Mahalanobis distance of the center: mean 3 where the covariance is honest.
  double azimuth_error_deg = 0;
  double radius_error_m = 0;
  double nearest_view_m = 0;
};

/// A flight through the course.
struct CourseFlight {
  std::vector<PathPoint> path;
  CourseOutcome outcome;
  std::vector<double> planned_clearance_m;  ///< As RingScene::rings: inner radius of the array − half span − 3σ; NaN
                                            ///< where the ring is not in the array or its plane was not met.
  FixCounts fixes;
  double end_error_m = 0;  ///< Of the believed position, horizontal.
};

struct RingFlight {
  RingScene scene;
  std::vector<PathPoint> scan;
  FixCounts scan_fixes;
  int scan_frames = 0;
  int sights = 0;
  DetectionCounts detections;
  std::vector<JudgedRing> array;  ///< In the order in which it is flown.
  std::vector<RingArray::Refused> refused;
  int found = 0;
  int false_rings = 0;
  CourseFlight with_fixes;
  CourseFlight without_fixes;  ///< The control: the same aircraft from the end of the scan on, with the same draws.

  int missed() const { return static_cast<int>(scene.rings.size()) - found; }
};

/// GNSS is gone from the beginning: the aircraft scans the field on its inertial navigation with fixes from `map`,
/// makes the array of rings, and flies through them twice, with fixes and without. All is drawn from `seed`.
RingFlight fly_rings(const RingField& field, MapReader& map, const RingFlightOptions& options, std::uint64_t seed);

}  // namespace pilotage
