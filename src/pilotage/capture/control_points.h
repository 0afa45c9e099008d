#pragma once

#include <string>
#include <vector>

#include "pilotage/capture/block.h"
#include "pilotage/geo/local_frame.h"

namespace pilotage {

/// Reads ground control points as OpenDroneMap's gcp_list.txt has them: the first line names their CRS ("EPSG:32616",
/// "WGS84 UTM 16N", a PROJ string), each further one is a mark: x, y, z (metres), column, row of a picture, its file,
/// and, optionally, the point's name. Marks of one name, or of one place, are one point. `files` are the frames' paths,
/// of which a mark names the end; marks in other pictures are counted in `unused_marks`. Points come in the local
/// frame. Throws DataError naming line and value.
std::vector<ControlPoint> read_control_points(const std::string& path, const std::vector<std::string>& files,
                                              const LocalFrame& frame, int& unused_marks);

}  // namespace pilotage
