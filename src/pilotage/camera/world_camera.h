#pragma once

#include <optional>
#include <string>
#include <vector>

#include "pilotage/base/nan.h"
#include "pilotage/camera/attitude.h"
#include "pilotage/camera/camera.h"
#include "pilotage/camera/render_frame.h"
#include "pilotage/geo/geodetic_point.h"
#include "pilotage/raster/elevation.h"
#include "pilotage/raster/gdal_crs.h"
#include "pilotage/raster/gray_source.h"

namespace pilotage {

/// Where a camera truly is, and how the aircraft that carries it truly lies in the air.
struct CameraPose {
  GeodeticPoint position;
  double height_agl_m = 0;      ///< Above the ground straight below.
  double height_amsl_m = kNaN;  ///< Above mean sea level; NaN where the height of the ground is not known.
  Attitude attitude;            ///< With whatever the camera's mount is off by.
};

/// What simulated cameras see: imagery in 8 bits, and heights where an elevation model is named.
struct RenderedWorld {
  GraySource ground;
  std::string elevation;           ///< GDAL dataset string; "": the ground is flat.
  bool of_the_map = true;          ///< The imagery is the mission's own: what is seen is what the map was made of.
  bool heights_of_the_map = true;  ///< The heights are the mission's own: what is seen is what the map reckons with.
};

/// Takes frames of a world: one object per thread.
class WorldCamera {
 public:
  /// `world` must outlive it. Throws DataError when the elevation cannot be opened.
  WorldCamera(const RenderedWorld& world, const Camera& camera);

  const Camera& camera() const { return camera_; }

  /// What the camera sees from `pose` (camera/render_frame.h): over the elevation, or flat where there is none. Where
  /// the elevation model knows nothing, or the pose is outside what the imagery's CRS can show, nothing of the frame is
  /// valid. The same frame for the same pose, whichever thread takes it. Throws UsageError for a pose that is no view
  /// (render_frame), DataError when imagery or elevation cannot be read.
  RenderedFrame frame_at(const CameraPose& pose) const;

  /// Whether all that the camera sees from `pose`, were the ground level, lies in the imagery (footprint_inside): false
  /// where it sees the horizon.
  bool is_over_imagery(const CameraPose& pose) const;

  /// Height above mean sea level of the ground; NaN where it is not known.
  double ground_amsl_m(GeodeticPoint point) const;

 private:
  std::optional<GroundPlace> place_below(const CameraPose& pose) const;

  const RenderedWorld* world_;
  Camera camera_;
  std::vector<Eigen::Vector3d> rays_;
  CrsTransform transform_;
  std::optional<Elevation> elevation_;
};

}  // namespace pilotage
