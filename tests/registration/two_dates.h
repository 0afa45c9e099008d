#pragma once

#include <functional>
#include <string_view>

#include <Eigen/Core>

#include "pilotage/raster/raster.h"
#include "pilotage/registration/register_dates.h"

namespace pilotage::testing {

/// Displacement of the second date at a point of the reference, metres.
using TrueField = std::function<Eigen::Vector2d(const Eigen::Vector2d& point_m)>;

/// Two pictures of one ground of random texture, CV_8U, 1 m per pixel, north-up from (1000, 5000): the reference shows
/// at p what the second date shows at p + field(p). All valid.
struct TwoDates {
  Raster reference;
  Raster second;
};

TwoDates make_two_dates(int side_px, const TrueField& field, std::string_view seed_name);

/// Random texture of several scales, CV_8U.
cv::Mat random_texture(int side_px, std::string_view seed_name);

/// Lit ground of the tones of `texture` (CV_8U, square), with the shadow of one thing for every 800 px, `shadow_px`
/// from where it stands. The same things for the same side.
cv::Mat ground_with_shadows(const cv::Mat& texture, const cv::Point& shadow_px);

/// Opens them on any grid whose pixels are a whole multiple of theirs (area averages), no ground outside.
OpenPair open_in_memory(const TwoDates& dates);

}  // namespace pilotage::testing
