#pragma once

#include <map>
#include <string>

namespace pilotage {

/// What a picture says of itself besides its pixels.
struct ImageMetadata {
  int width_px = 0;
  int height_px = 0;
  /// EXIF tags by their names without a prefix ("FocalLength"), as GDAL writes values: numbers that EXIF holds as
  /// fractions stand in parentheses, lists of them one after the other, "(46) (50) (34.3145)".
  std::map<std::string, std::string> exif;
  /// Simple properties of the XMP packet by their names with the packet's own prefix ("drone-dji:RelativeAltitude"),
  /// whether they are written as attributes or as elements; of equal names the first. Blanks around values are dropped.
  std::map<std::string, std::string> xmp;
};

/// Reads them from anything GDAL opens; a packet that is no XML counts as none. Throws DataError, naming the dataset,
/// when it cannot be opened as a raster.
ImageMetadata read_image_metadata(const std::string& dataset);

}  // namespace pilotage
