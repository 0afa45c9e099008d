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

/// All labels of options.labels in `crs` (metres), by class_field, class_name and classes. Closed lines are outlines
/// like polygons; of polygons the outline alone counts. Throws DataError as read_shapes() and read_annotations(), for a
/// picture that has no place on the ground, a point whose size nobody says, an open line, and a label without extent,
/// naming the label; when there is no label of the classes; and when two labels of different classes cover the same
/// ground (bounds_overlap() above 0.7), naming both. Of such labels of one class the first that is not ignored is
/// kept; `merged` counts the others.
std::vector<LandmarkLabel> read_landmark_labels(const LabelSourceOptions& options, const Crs& crs, int& merged);

}  // namespace pilotage
