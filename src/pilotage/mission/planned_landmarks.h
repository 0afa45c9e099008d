#pragma once

#include <string>

#include "pilotage/ground/ground.h"
#include "pilotage/mapdb/map_landmarks.h"

namespace pilotage {

/// Those of all landmarks that lie on a tile of the ground, and the detectors that find any of them. Throws DataError
/// that begins with the name of their file when none does.
MapLandmarks landmarks_on_tiles(const Ground& ground, const MapLandmarks& all, const std::string& path);

/// The landmarks of a file (landmark_file.h) on the ground of any tile that was planned (a frame over a stored one
/// shows its neighbours, too), with heights of their ground, and the detectors that find any of them. Throws DataError
/// when the file cannot be read or none lies there.
MapLandmarks read_planned_landmarks(const Ground& ground, const std::string& path);

}  // namespace pilotage
