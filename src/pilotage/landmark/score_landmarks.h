#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "pilotage/base/options.h"
#include "pilotage/base/progress.h"
#include "pilotage/base/statistics.h"
#include "pilotage/geo/geodetic_point.h"
#include "pilotage/landmark/label_options.h"
#include "pilotage/landmark/landmark_model.h"
#include "pilotage/mapdb/map_landmarks.h"
#include "pilotage/raster/gdal_crs.h"

namespace pilotage {

/// How detectors are judged on imagery of another date.
struct LandmarkScoreOptions {
  std::vector<std::string> second_epoch;
  double search_radius_m = 200;
  LabelSourceOptions labels;
  std::string for_map;
  std::string crs;
  ImageryOptions imagery;

  template <class Self, class Fields>
  static void describe(Self& self, Fields& fields) {
    fields.path("second_epoch", self.second_epoch,
                "Imagery of another date than the detectors learnt (GDAL datasets, later ones on top).");
    fields.field("search_radius_m", self.search_radius_m,
                 "How far off an aircraft may believe itself: within it others of a class, and what is taken for one, "
                 "make a landmark ambiguous.",
                 Range{1, 100000});
    LabelSourceOptions::describe(self.labels, fields);
    fields.path("for_map", self.for_map,
                "Also write the detectors, the landmarks and what was measured of them, for `build --landmarks`.");
    fields.field("crs", self.crs, "CRS of the search, projected in metres; chosen if not given.");
    ImageryOptions::describe(self.imagery, fields);
  }
};

enum class LandmarkFate { kFound, kMissed, kFalseAlarm };

inline EnumNames<LandmarkFate> enum_names(LandmarkFate) {
  return {
      {LandmarkFate::kFound, "found"}, {LandmarkFate::kMissed, "missed"}, {LandmarkFate::kFalseAlarm, "false_alarm"}};
}

/// A landmark, or what was taken for one.
struct ScoredLandmark {
  std::string class_name;
  LandmarkFate fate = LandmarkFate::kMissed;
  GeodeticPoint place;  ///< Of the label; of a false alarm that of the hit.
  double score = 0;     ///< NaN when it was missed.
  double east_m = 0;    ///< Hit less label, along the axes of the search's CRS; NaN unless found.
  double north_m = 0;
  double length_m = 0;   ///< Of the label; of a false alarm that of the hit.
  bool learnt = false;   ///< The detector learnt it, on another date or this one.
  double ambiguity = 0;  ///< Expected hits of its class within the search radius that are not it.
};

/// A rate of rare things on ground.
struct Density {
  std::int64_t count = 0;
  double area_km2 = 0;
  double value() const;       ///< For each km².
  Interval interval() const;  ///< Exact for a Poisson count, confidence 0.95.
};

/// How well one class is found.
struct ScoredClass {
  std::string class_name;
  Share recall;            ///< Of all labels,
  Share recall_elsewhere;  ///< and of those that it did not learn.
  double average_precision = 0;
  Density false_alarms;
  double error_median_m = 0;  ///< Length of the errors of what was found; NaN of none.
  double error_95_m = 0;
  double sigma_m = 0;         ///< Root mean square of them, each axis.
  Interval sigma_interval_m;  ///< Confidence 0.95, if they are normal.
  double median_ambiguity = 0;
};

struct LandmarkScores {
  Crs crs;
  std::vector<ScoredClass> classes;
  std::vector<ScoredLandmark> landmarks;  ///< By class, labels first.
  std::string acquired;                   ///< Date of the imagery, "" when it does not say.
  std::int64_t outside = 0;               ///< Labels that the imagery does not show,
  std::int64_t other_date = 0;            ///< or that were not there when it was taken.
  std::vector<std::string> warnings;
};

/// What a map holds of landmarks: the detectors that were judged and found something, and the landmarks that the
/// imagery shows, found or not.
MapLandmarks landmarks_for_map(const LandmarkModel& model, const LandmarkScores& scores);

/// Looks for every landmark of the labels with the model's detectors on options.second_epoch, all over it, in blocks of
/// bounded memory. A hit at a label's middle, to half its length, finds it; every other one is a false alarm, so all
/// landmarks of these classes that the imagery shows must be labelled. Deterministic for any number of threads. Throws
/// UsageError; DataError as read_landmark_labels(), when no label is of a class that the model knows or none is shown
/// (a class of which none is shown is left out with a warning); Interrupted.
LandmarkScores score_landmarks(const LandmarkModel& model, const LandmarkScoreOptions& options, int threads,
                               const Progress& progress = {});

}  // namespace pilotage
