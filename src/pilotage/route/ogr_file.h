#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <gdal_priv.h>
#include <ogr_spatialref.h>
#include <ogrsf_frmts.h>

#include "pilotage/raster/gdal_handle.h"
#include "pilotage/route/ogr_memory_file.h"
#include "pilotage/route/ogr_route.h"
#include "pilotage/route/ogr_track.h"
#include "pilotage/route/route_line.h"

// Private to route/ogr_*.cc: files of vectors through OGR.

namespace pilotage {

/// A file of vectors that OGR has open, read from memory.
class OgrFile {
 public:
  /// `name` stands in messages; of a KMZ the bytes are those of its document. Throws DataError when they cannot be read
  /// as `format`, and as kml_tracks.
  OgrFile(const std::string& name, std::string_view bytes, OgrFormat format);

  const char* title() const { return title_; }  ///< "GeoJSON"
  GDALDataset& dataset() const { return *dataset_; }
  const std::vector<KmlTrack>& tracks() const { return tracks_; }  ///< Of KML, what OGR leaves out of them.
  /// Throws DataError when OGR has met damage since the file was opened.
  void check_whole() const;

 private:
  std::string name_;
  const char* title_;
  GdalErrors errors_;
  std::vector<KmlTrack> tracks_;
  OgrMemoryFile file_;
  std::unique_ptr<GDALDataset> dataset_;
};

/// Longitude and latitude out of the layer's CRS; coordinates that look like degrees need none.
class ToWgs84 {
 public:
  /// `where` stands in messages. Throws DataError when the layer's CRS cannot be brought to WGS 84.
  ToWgs84(OGRLayer& layer, const std::string& where);

  /// Throws DataError naming a point that cannot be.
  void apply(std::vector<LinePoint>& points) const;

 private:
  std::string where_;
  std::unique_ptr<OGRCoordinateTransformation> transform_;
};

}  // namespace pilotage
