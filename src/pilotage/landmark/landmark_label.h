#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "pilotage/landmark/label_options.h"
#include "pilotage/raster/gdal_crs.h"

namespace pilotage {

/// A landmark that somebody labelled, on the map.
struct LandmarkLabel {
  std::string class_name;
  std::vector<Eigen::Vector2d> outline_m;  ///< In the CRS that was asked for; three corners at least.
  bool box_alone = false;                  ///< As of PictureLabel.
  bool ignore = false;
  std::string start_date;  ///< "YYYY", "YYYY-MM" or "YYYY-MM-DD" as OpenStreetMap has it; "" when not said.
  std::string end_date;
  std::string name;  ///< For messages.
};

/// The days that imagery was taken, "YYYY-MM-DD"; "" where it does not say.
struct ImageryDates {
  std::string first;
  std::string last;

  void add(const std::string& acquired);
};

/// Why a landmark cannot be seen on imagery of these dates, as a clause, or "". A day is compared with a year as a
/// year.
std::string date_misfit(const LandmarkLabel& label, const ImageryDates& dates);

/// Labels of several files.
struct LandmarkLabels {
  std::vector<LandmarkLabel> labels;
  int merged = 0;  ///< Labels of what another one of their class had labelled.
  /// Labels that are nowhere on the map, with the reason: "extract.osm: layer …: a ring of a polygon has …".
  std::vector<std::string> nowhere;
  std::vector<std::string> warnings;
};

/// All labels of options.labels in `crs` (metres), by class_field, class_name and classes. Closed lines are outlines
/// like polygons; of polygons the outline alone counts. `imagery_crs`: of pictures of annotations that state none.
/// Throws DataError as read_shapes() and read_annotations(), for a picture whose place the label's pixels do not tell
/// (no georeference, control points, another size than the annotations say), a label that reaches out of its picture, a
/// point whose size nobody says, an open line, a label without class, naming the label; when there is no label of the
/// classes; and when two labels of different classes are of one thing (overlap() of their smallest rectangles above
/// 0.7), naming both. Of such labels of one class the first that is not ignored is kept.
LandmarkLabels read_landmark_labels(const LabelSourceOptions& options, const std::string& imagery_crs, const Crs& crs);

}  // namespace pilotage
