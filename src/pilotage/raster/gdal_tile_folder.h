#pragma once

#include <string>
#include <vector>

#include "pilotage/raster/gdal_handle.h"

// Private to raster/gdal_*.cc: a folder of a web map's tiles, FOLDER/z/x/y.png, as one raster.

namespace pilotage {

/// Whether the name is of a folder that holds a folder named by a number, as tiles lie: z/x/y.
bool is_tile_folder(const std::string& name);

/// The deepest zoom level of a folder of tiles z/x/y.png, .jpg, .jpeg or .webp (or y@2x.png) as one raster in EPSG:3857
/// with the bands red, green, blue, alpha; where no tile lies, it is transparent. Rows count from the north (XYZ)
/// unless the folder says that they count from the south (TMS): by the tilemapresource.xml of gdal2tiles, or by
/// "scheme": "tms" in its metadata.json (TileJSON), where "scheme": "zyx" says that rows come before columns. The
/// folder is read once in a run. Throws DataError, naming the tile or the folder, for tiles that are not pictures of
/// one size of 8 bits, symbolic links, a level without tiles or with more than 200,000, a profile that is not the web's
/// Mercator.
DatasetPtr open_tile_folder(const std::string& folder);

/// What is worth knowing of such a folder, as sentences: which rule for rows was taken where it does not say so, a
/// shallower level that covers more ground than the one that is read.
std::vector<std::string> tile_folder_warnings(const std::string& folder);

}  // namespace pilotage
