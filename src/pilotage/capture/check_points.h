#pragma once

#include <string>
#include <vector>

#include "pilotage/capture/capture.h"
#include "pilotage/capture/capture_frames.h"
#include "pilotage/capture/ortho_mosaic.h"

namespace pilotage {

/// Throws DataError naming a check point that is a control point as well, or as near one as 1 cm: it would check
/// itself.
void refuse_adjusted_checks(const std::vector<ControlPoint>& checks, const std::vector<ControlPoint>& control_points);

/// How far the map shows surveyed points from where they are: where the ray of a point's mark meets the surface, in the
/// frame that the map shows there, less the point. Where that frame has no mark of it, the marked frame whose nadir is
/// nearest stands for it. Points that the map does not show, or no ray reaches, are left out.
std::vector<CheckedPoint> check_map(const std::vector<ControlPoint>& checks, const CaptureFrames& frames,
                                    const OrthoMosaic& mosaic, const MosaicStats& drawn);

}  // namespace pilotage
