#pragma once

#include <string>
#include <string_view>

#include "pilotage/camera/camera.h"
#include "pilotage/raster/gdal_xml.h"

namespace pilotage {

// Cameras as programs for photogrammetry write them. Both count pixels from the corner of the image, as Pilotage does.

/// Whether the first line of the text that is no comment looks like one of COLMAP's cameras.txt: a number, a model in
/// capitals, two sizes.
bool looks_like_colmap_cameras(std::string_view text);

/// The camera of a cameras.txt of COLMAP, which must have one: SIMPLE_PINHOLE, PINHOLE, SIMPLE_RADIAL, RADIAL, OPENCV,
/// FULL_OPENCV (with k4 to k6 zero), and of the fisheyes OPENCV_FISHEYE, SIMPLE_RADIAL_FISHEYE, RADIAL_FISHEYE. `name`
/// stands for the file in messages. Throws DataError naming line, model and number.
Camera parse_colmap_cameras(const std::string& name, std::string_view text);

/// The camera of a calibration that Agisoft Metashape writes as XML, by its root `calibration`: frame or fisheye
/// projection, f, cx, cy from the middle of the image, k1, k2, k3, p1, p2 (in the order of Agisoft: p1 along the
/// image's rows), b1. Skew (b2), k4 of a frame camera and p1, p2 of a fisheye must be 0. Throws DataError naming the
/// element.
Camera agisoft_camera(const std::string& name, const XmlElement& calibration);

}  // namespace pilotage
