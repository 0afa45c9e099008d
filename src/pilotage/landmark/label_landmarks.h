#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "pilotage/base/progress.h"
#include "pilotage/landmark/label_options.h"
#include "pilotage/raster/gdal_crs.h"

namespace pilotage {

/// What was labelled of one class.
struct LabelledClass {
  std::string class_name;
  std::int64_t labels = 0;
  double shortest_m = 0;  ///< Lengths of the smallest rectangles around them.
  double median_m = 0;
  double longest_m = 0;
};

struct LabelledChips {
  Crs crs;
  double gsd_m = 0;
  std::vector<LabelledClass> classes;  ///< By name.
  std::int64_t background_chips = 0;
  std::int64_t outside = 0;        ///< Skipped: not wholly on ground that the imagery shows.
  std::int64_t other_date = 0;     ///< Skipped: not there when the imagery was taken.
  int merged = 0;                  ///< Labels of what another one of their class had labelled.
  std::vector<std::string> files;  ///< Names in the folder, the annotations first.
  std::vector<std::string> warnings;
};

inline constexpr const char* kChipAnnotations = "labels.xml";
inline constexpr const char* kLabelShapes = "labels.geojson";

/// Cuts a north-up chip of the imagery around each label, 3.2 times as long as it (less at the imagery's edge, where it
/// is shifted or cut; what is no ground there is as gray as the rest on average) and on the pixels of one grid, and
/// chips of ground without labels, and writes them into `folder` (8-bit PNG, georeferenced by .aux.xml beside each):
/// labels.xml, imglab's annotations of the chips, each with one label of its own, others on it ignored;
/// labels.geojson, the labels on the ground. `inputs`: GDAL datasets, later ones on top, or one tile plan, whose finest
/// level is the grid. 16-bit imagery is stretched to 8 bits as features are. All files appear, or none. Throws
/// UsageError; DataError as read_landmark_labels(), for labels that do not fit the imagery (LabelOptions::unfit), when
/// none is left, and when a file exists and `overwrite` is false; Interrupted.
LabelledChips label_landmarks(const std::vector<std::string>& inputs, const LabelOptions& options,
                              const std::filesystem::path& folder, bool overwrite, std::uint64_t seed,
                              const Progress& progress = {});

}  // namespace pilotage
