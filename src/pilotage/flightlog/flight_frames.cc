#include "pilotage/flightlog/flight_frames.h"

#include "pilotage/base/error.h"
#include "pilotage/base/text.h"

namespace pilotage {
namespace {

std::optional<Camera> camera_without_exif(const FrameSources& sources) {
  return sources.given ? sources.given : sources.of_map;
}

Camera require_camera(const std::optional<Camera>& camera, const std::string& path) {
  if (camera) return *camera;
  throw UsageError(path + ": there is no camera: the map has none; give --camera");
}

}  // namespace

FlightFrames complete_frame(const std::string& path, const FrameRecord& frame, const FrameSources& sources) {
  FlightFrames done;
  FlightFrame complete{path, frame, {}};
  std::optional<Camera> camera = camera_without_exif(sources);
  std::optional<FrameExif> exif;
  if (sources.from_exif) exif = frame_exif(read_image_metadata(path));
  if (exif) {
    for (const std::string& warning : exif->warnings) done.warnings.push_back(path + ": " + warning);
  }
  if (auto own = exif && !sources.given ? exif_camera(*exif) : std::nullopt) {
    own->value.mount = sources.exif_mount;
    camera = own->value;
    done.taken.push_back({frame.file, "camera.fx_px", own->value.fx_px, own->tag});
  }
  complete.camera = require_camera(camera, path);
  if (exif) {
    const std::vector<TakenField> filled = fill_from_exif(complete.frame, *exif, complete.camera.mount);
    done.taken.insert(done.taken.end(), filled.begin(), filled.end());
  }
  if (const std::vector<std::string> missing = missing_fields(complete.frame); !missing.empty()) {
    done.warnings.push_back(path + ": " + join(missing, ", ") + (missing.size() > 1 ? " are" : " is") + " not known");
  }
  done.frames.push_back(std::move(complete));
  return done;
}

FlightFrames complete_frames(const std::string& table_path, const FrameTable& table, const FrameSources& sources) {
  FlightFrames all;
  all.warnings = table.warnings;
  for (const FrameRecord& frame : table.frames) {
    const std::string path = frame_path(table_path, frame.file);
    FlightFrames one;
    try {
      one = complete_frame(path, frame, sources);
    } catch (const DataError&) {  // not a picture: its row in the result will say so
      one.frames.push_back({path, frame, require_camera(camera_without_exif(sources), path)});
    }
    all.frames.insert(all.frames.end(), one.frames.begin(), one.frames.end());
    all.taken.insert(all.taken.end(), one.taken.begin(), one.taken.end());
    all.warnings.insert(all.warnings.end(), one.warnings.begin(), one.warnings.end());
  }
  return all;
}

}  // namespace pilotage
