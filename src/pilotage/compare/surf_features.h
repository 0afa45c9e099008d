#pragma once

#include "pilotage/compare/descriptor_method.h"

namespace pilotage {

/// SURF by dlib 19.24 (H. Bay, A. Ess, T. Tuytelaars, L. Van Gool, CVIU 110, 2008; after C. Evans, "Notes on the
/// OpenSURF Library", 2009): dlib::get_surf_points() step by step, so that detection and description are timed apart
/// and only allowed points count towards `max_features`. 4 octaves of 6 intervals; no point nearer to the image's edge
/// than 32 times its scale; images of at least 64 px on a side. Descriptors are CV_32F (dlib's doubles rounded). As
/// describe_image otherwise.
DescribedImage surf_features(const cv::Mat& gray, const cv::Mat& allowed, int max_features);

}  // namespace pilotage
