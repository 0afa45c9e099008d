#pragma once

#include <optional>
#include <string>
#include <vector>

#include "pilotage/base/options.h"
#include "pilotage/raster/gdal_imagery.h"

namespace pilotage {

/// What becomes of labels that do not fit the imagery.
enum class UnfitLabels {
  kRefuse,  ///< An error that names the first of them.
  kSkip,    ///< They are left out, and counted.
};

inline EnumNames<UnfitLabels> enum_names(UnfitLabels) {
  return {{UnfitLabels::kRefuse, "refuse"}, {UnfitLabels::kSkip, "skip"}};
}

/// Where labels come from, and what is taken of them.
struct LabelSourceOptions {
  std::vector<std::string> labels;
  std::string class_name;
  std::string class_field = "class";
  std::vector<std::string> classes;
  std::string class_names;
  std::optional<double> diameter_m;

  template <class Self, class Fields>
  static void describe(Self& self, Fields& fields) {
    fields.path("labels", self.labels,
                "Labels, by content: GeoJSON, GeoPackage, KML, KMZ or an OpenStreetMap extract (.osm, .osm.pbf); or "
                "annotations of pictures that know their place: imglab XML, Pascal VOC, COCO, YOLO (.txt).");
    fields.field("class", self.class_name, "All labels are of this class.");
    fields.field("class_field", self.class_field,
                 "Property of shapes that says their class, \"man_made\" for instance; shapes without it are no "
                 "labels.");
    fields.field("classes", self.classes, "Only labels of these classes. Default: of all.");
    fields.path("class_names", self.class_names,
                "YOLO: file with a class in each line. Default: classes.txt or obj.names beside the labels.");
    fields.field("diameter_m", self.diameter_m,
                 "Diameter of labels that are points and have no property diameter: they are taken for round.",
                 Range{0.1, 10000});
  }
};

/// How landmarks are labelled on imagery.
struct LabelOptions : LabelSourceOptions {
  UnfitLabels unfit = UnfitLabels::kRefuse;
  std::optional<int> background_chips;
  std::optional<double> gsd_m;
  std::string crs;
  ImageryOptions imagery;

  template <class Self, class Fields>
  static void describe(Self& self, Fields& fields) {
    LabelSourceOptions::describe(self, fields);
    fields.field("unfit", self.unfit,
                 "Labels that do not fit the imagery: not wholly on ground that it shows, begun after its date "
                 "(start_date) or ended before it (end_date). Refused, the first by name; or skipped and counted.");
    fields.field("background_chips", self.background_chips,
                 "Chips of ground without a label, drawn at random. Default: as many as there are labels.",
                 Range{0, 100000});
    fields.field("gsd_m", self.gsd_m,
                 "Ground sample distance of the chips. Default: the imagery's own pixels where they are square, "
                 "north-up and in metres; else resampled to their size.",
                 Range{0.001, 100});
    fields.field("crs", self.crs, "CRS of the chips' grid, projected in metres; chosen if not given.");
    ImageryOptions::describe(self.imagery, fields);
  }
};

}  // namespace pilotage
