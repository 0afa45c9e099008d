#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "pilotage/camera/camera.h"
#include "pilotage/flightlog/frame_exif.h"
#include "pilotage/mission/frame_table.h"

namespace pilotage {

/// Names of the pictures in a folder (.jpg, .jpeg, .png, .tif, .tiff, .pgm, in any case) in their order, numbers in
/// them as numbers. Throws DataError when it cannot be read, or holds none.
std::vector<std::string> pictures_of_folder(const std::filesystem::path& folder);

/// A frame to match: where its picture is, what the aircraft believed, how the camera sees.
struct FlightFrame {
  std::string path;
  FrameRecord frame;
  Camera camera;
};

/// Where the camera comes from, first to last: `given`; with from_exif the picture's own focal length; the map's.
struct FrameSources {
  std::optional<Camera> given;
  std::optional<Camera> of_map;
  bool from_exif = false;  ///< Fill what a record does not have from the picture (frame_exif.h).
  CameraMount exif_mount;  ///< How the camera of `from_exif` sits on the aircraft.
};

struct FlightFrames {
  std::vector<FlightFrame> frames;
  std::vector<TakenField> taken;      ///< What came from the pictures; the focal length as "camera.fx_px".
  std::vector<std::string> warnings;  ///< Fields that a frame does not have at all (NaN): matching will refuse it.
};

/// The frame at `path` with what `frame` says of it, completed from `sources`. Throws UsageError when there is no
/// camera; with from_exif DataError when the picture cannot be opened.
FlightFrames complete_frame(const std::string& path, const FrameRecord& frame, const FrameSources& sources);

/// All frames of a table that stands at `table_path`. Pictures that cannot be opened stay as the table has them.
FlightFrames complete_frames(const std::string& table_path, const FrameTable& table, const FrameSources& sources);

}  // namespace pilotage
