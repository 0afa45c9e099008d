#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "pilotage/base/options.h"
#include "pilotage/base/progress.h"
#include "pilotage/base/statistics.h"
#include "pilotage/ground/tile_scores.h"
#include "pilotage/mapdb/parallel_reading.h"
#include "pilotage/match/match.h"
#include "pilotage/mission/mission.h"
#include "pilotage/mission/selection.h"

namespace pilotage {

/// What is varied: what the flight is like, what the matcher is told, what spoils its frames.
enum class EnvelopeFactor {
  kPlanned,
  kHeight,
  kHeading,
  kGsdRatio,
  kAttitudeError,
  kPositionError,
  kFog,
  kClouds,
  kDark,
  kMotionBlur,
  kDrops,
  kJpeg
};
inline EnumNames<EnvelopeFactor> enum_names(EnvelopeFactor) {
  return {{EnvelopeFactor::kPlanned, "planned"},
          {EnvelopeFactor::kHeight, "height_m"},
          {EnvelopeFactor::kHeading, "heading_deg"},
          {EnvelopeFactor::kGsdRatio, "gsd_ratio"},
          {EnvelopeFactor::kAttitudeError, "attitude_error_deg"},
          {EnvelopeFactor::kPositionError, "position_error_m"},
          {EnvelopeFactor::kFog, "fog_visibility_m"},
          {EnvelopeFactor::kClouds, "cloud_cover"},
          {EnvelopeFactor::kDark, "dark_stops"},
          {EnvelopeFactor::kMotionBlur, "motion_blur_px"},
          {EnvelopeFactor::kDrops, "lens_drops"},
          {EnvelopeFactor::kJpeg, "jpeg_quality"}};
}

/// What is varied about the plan, one factor at a time (heights in each world). Errors are one standard deviation.
struct EnvelopeOptions {
  int places = 40;
  std::vector<std::string> world;
  std::vector<EnvelopeFactor> factors;
  std::string height_m = "60:300:20";
  std::string heading_deg = "0:315:45";
  std::string gsd_ratio = "0.5,0.7,1,1.4,2,3";
  std::string attitude_error_deg = "0,0.5,1,2,4";
  std::string position_error_m = "10,30,60,100,200,400";
  std::string fog_visibility_m = "30,50,80,125,250,500,1000";
  std::string cloud_cover = "0.2,0.4,0.6,0.8,0.9";
  std::string dark_stops = "4,8,10,12,14";
  std::string motion_blur_px = "4,8,16,32,64";
  std::string lens_drops = "30,100,300,1000";
  std::string jpeg_quality = "1,2,5,10,20";
  int frame_width_px = 640;
  double prior_sigma_m = 10;
  double tilt_sigma_deg = 2;
  double attitude_sigma_deg = 0.5;
  double altimeter_sigma = 0.02;
  double degradation = 1;
  double correct_within_m = 5;
  MatchOptions match;

  template <class Self, class Fields>
  static void describe(Self& self, Fields& fields) {
    fields.field("places", self.places, "At so many stored places of the route, at most all.", Range{1, 10000});
    fields.path("world", self.world,
                "The ground that frames show: rasters of other dates. Default: the mission's own imagery, changed as "
                "`score` changes it.");
    fields.field("factors", self.factors,
                 "Vary these alone, whatever values the others have. Default: all that have values.");
    fields.field("height_m", self.height_m,
                 "Heights above the ground, FIRST:LAST:STEP or numbers with commas, in each world; \"\": none.");
    fields.field("heading_deg", self.heading_deg, "Directions of the nose, turned from the course; \"\": none.");
    fields.field("gsd_ratio", self.gsd_ratio, "Pixels of the frame on the ground, times the planned ones; \"\": none.");
    fields.field("attitude_error_deg", self.attitude_error_deg,
                 "Errors of roll, pitch and yaw that the matcher is told; \"\": none.");
    fields.field(
        "position_error_m", self.position_error_m,
        "Errors of the position that the matcher is told, on each axis, and its standard deviation; \"\": none.");
    fields.field("fog_visibility_m", self.fog_visibility_m,
                 "Fog between the ground and the aircraft: meteorological optical ranges, metres; \"\": none.");
    fields.field("cloud_cover", self.cloud_cover, "Shares of the frame that clouds hide, 0 to 1; \"\": none.");
    fields.field("dark_stops", self.dark_stops,
                 "Dusk: factors of two less light than a full exposure has, gain turned up as much; \"\": none.");
    fields.field("motion_blur_px", self.motion_blur_px,
                 "Motion of the ground across the frame while the shutter is open, pixels of the frame as rendered; "
                 "\"\": none.");
    fields.field("lens_drops", self.lens_drops, "Numbers of drops of rain on the lens; \"\": none.");
    fields.field("jpeg_quality", self.jpeg_quality,
                 "Qualities of JPEG, 1 to 100, at which a link hands on the frames as rendered; \"\": none.");
    fields.field("frame_width_px", self.frame_width_px,
                 "Frames are rendered so wide, or as wide as the mission's camera if that is less.", Range{16, 10000});
    fields.field("prior_sigma_m", self.prior_sigma_m,
                 "Error of the position that the matcher is told, on each axis, where that is not what is varied.",
                 Range{0.1, 1000});
    fields.field("tilt_sigma_deg", self.tilt_sigma_deg, "How far the aircraft rolls and pitches.", Range{0, 20});
    fields.field("attitude_sigma_deg", self.attitude_sigma_deg,
                 "Error of roll, pitch and yaw where that is not what is varied.", Range{0, 20});
    fields.field("altimeter_sigma", self.altimeter_sigma,
                 "Error of the height above ground that the matcher is told, as a share of it.", Range{0, 0.3});
    fields.field("degradation", self.degradation,
                 "How much the mission's own imagery is changed, in units of the defaults of `score`; 0: not at all.",
                 Range{0, 1.5});
    fields.field("correct_within_m", self.correct_within_m, "A fix with a larger error is false.", Range{0.001, 1e6});
    fields.group("match", self.match, "What the matcher is told.");
  }
};

/// The numbers of "60:300:20" (both ends, as far as steps lead) or "1,2,5"; none of "". Throws UsageError naming `name`
/// for what is neither, for more than 1,000 numbers, and for numbers outside `range`.
std::vector<double> envelope_values(const std::string& name, const std::string& text, Range range);

/// One value of one factor in one world, at all places.
struct EnvelopeCell {
  EnvelopeFactor factor = EnvelopeFactor::kPlanned;
  double value = 0;         ///< 0 for kPlanned.
  std::size_t world = 0;    ///< Index into Envelope::worlds.
  std::int64_t frames = 0;  ///< Places where the world has imagery for a frame.
  std::int64_t correct = 0;
  std::int64_t wrong = 0;                                             ///< False fixes.
  double largest_error_m = std::numeric_limits<double>::quiet_NaN();  ///< Of the fixes; NaN without one.

  Share correct_share() const { return {correct, frames}; }
  double p() const { return frames > 0 ? correct_share().value() : 0; }
  Share wrong_share() const { return {wrong, correct + wrong}; }  ///< Of the fixes.
};

/// How far a world's heights may be from the planned one.
struct HeightMargin {
  std::size_t world = 0;
  double planned_p = 0;
  /// The heights next to the planned one, and all between, whose interval of P begins at 0.5 or above; nothing where
  /// the planned height's does not.
  std::optional<Interval> sure_m;
  /// Likewise: P is at least 0.9 of the planned one.
  std::optional<Interval> as_good_m;
};

struct EnvelopePlace {
  std::int64_t tile_id = 0;
  double p = 0;            ///< Of a right fix, as the plan counts it.
  std::size_t sample = 0;  ///< Of the route.
};

struct Envelope {
  EnvelopeOptions options;
  std::uint64_t seed = 0;
  int frame_width_px = 0;             ///< As rendered: pixels of motion and qualities of JPEG are of such frames.
  std::vector<std::string> worlds;    ///< As given; "" is the mission's own imagery.
  double planned_height_m = 0;        ///< Median of the places.
  std::vector<EnvelopePlace> places;  ///< Ascending P.
  std::vector<EnvelopeCell> cells;
  std::vector<HeightMargin> margins;  ///< Of each world, where heights are varied.
  std::vector<std::string> notes;
};

/// Places for the envelope: the stored tiles that the route tries, in strata of equal count by their P, one of each by
/// the seed.
std::vector<EnvelopePlace> envelope_places(const Mission& mission, const std::vector<TileScores>& scores,
                                           const Selection& selection, int count, std::uint64_t seed);

/// Margins of the heights that were tried: cells of kHeight beside that of kPlanned.
HeightMargin height_margin(const std::vector<EnvelopeCell>& cells, std::size_t world, double planned_height_m);

/// Renders, matches and counts. The same places and random numbers in each cell. Deterministic for any number of
/// threads. Throws UsageError as envelope_values and for a deadline of the matcher, DataError for imagery, map or
/// elevation, and where no stored tile lies under the route; Interrupted.
Envelope make_envelope(const Mission& mission, const std::vector<TileScores>& scores, const Selection& selection,
                       const OpenMaps& open_maps, const EnvelopeOptions& options, std::uint64_t seed, int threads,
                       const Progress& progress);

}  // namespace pilotage
