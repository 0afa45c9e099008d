#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

namespace pilotage {

/// Something that was drawn on a picture and given a class.
struct PictureLabel {
  std::string class_name;  ///< "" where the file gives none.
  /// Corners in pixels of the picture (as GeoTransform counts them), three at least; of a box its four.
  std::vector<Eigen::Vector2d> outline_px;
  bool box_alone = false;  ///< Nothing is known but an upright box around it: neither its form nor its heading.
  bool ignore = false;     ///< Neither to be found nor to be missed.
  std::string name;        ///< For messages: "labels.xml: chip_0003.png, box 2".
};

/// A picture and what is labelled on it.
struct AnnotatedPicture {
  std::filesystem::path picture;  ///< As it can be opened: beside the file of annotations.
  int width_px = 0;               ///< As the annotations say, 0 where they do not.
  int height_px = 0;
  std::vector<PictureLabel> labels;
};

/// Whether a file is annotations of pictures (read_annotations) and not shapes on the ground; told by its content and,
/// for YOLO, by its name. Throws DataError when it cannot be read.
bool is_annotation_file(const std::filesystem::path& path);

/// The pictures of a file of annotations, by content:
///   - dlib's imglab, `<dataset><images><image file=…><box top= left= width= height= angle= ignore=><label>…`: the
///     box turned clockwise by its angle (radians) about its middle; three or more parts whose names are numbers are
///     the outline, in their order;
///   - Pascal VOC, `<annotation><filename>…<object><name>…<bndbox>…`, pixels counted from 1, both ends included;
///   - COCO (JSON with images, annotations and categories): the largest polygon of the segmentation, else the box;
///     crowds are ignored;
///   - YOLO (.txt): "class x y width height", shares of the picture, or "class x1 y1 x2 y2 x3 y3 …", an outline. The
///     picture has the name of the file and stands beside it or in a folder images beside its own; classes are lines
///     of `class_names`, else of a file classes.txt or obj.names beside it or one folder above.
/// Pictures are looked for beside the file; what VOC and COCO name is also looked for in folders images and JPEGImages
/// there and one folder above. With `class_names_asked` false, classes of YOLO stay without names. Throws DataError
/// naming file and label: what is not as above, a box without extent, a class that has no name, a picture that is not
/// there.
std::vector<AnnotatedPicture> read_annotations(const std::filesystem::path& path,
                                               const std::filesystem::path& class_names = {},
                                               bool class_names_asked = true);

/// imglab XML of pictures whose outlines are its parts, boxes around them, and the heading of their long axis its
/// angle. `name` is the title of the file.
std::string imglab_xml(const std::vector<AnnotatedPicture>& pictures, std::string_view name);

}  // namespace pilotage
