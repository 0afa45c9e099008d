#pragma once

#include <string>
#include <vector>

#include "pilotage/base/progress.h"
#include "pilotage/raster/licence.h"

#pragma GCC visibility push(default)

namespace pilotage {

/// A rectangle in longitude and latitude, WGS 84; over the antimeridian west_deg > east_deg.
struct DegreeBounds {
  double west_deg = 0;
  double south_deg = 0;
  double east_deg = 0;
  double north_deg = 0;

  bool intersects(const DegreeBounds& other) const;
};

/// Imagery that a STAC catalogue names.
struct StacAsset {
  std::string item;     ///< The item's id.
  std::string key;      ///< The asset's key in it: "visual".
  std::string dataset;  ///< For GDAL: a file, or "/vsicurl/https://…".
  std::string
      acquired;  ///< "2023-06-14", or with the time "2023-06-14T10:30:00Z"; "" where none, or no one day, is said.
  bool of_several_days = false;  ///< It says an interval, as of a mosaic: no tag of the raster may stand for a day.
  Licence licence;               ///< Of the item, else of its collection.
};

/// What is read of catalogues, at most.
inline constexpr std::size_t kMaxStacFileBytes = std::size_t{64} << 20;
inline constexpr std::size_t kMaxStacFiles = 10'000;
inline constexpr std::size_t kMaxStacBytes = std::size_t{1} << 30;  ///< Of all files together.
inline constexpr std::size_t kMaxStacAssets = 100'000;

struct StacAssets {
  std::vector<StacAsset> assets;     ///< Each raster once.
  std::vector<std::string> skipped;  ///< Items without an asset that is plainly the imagery, and why: sentences.
};

/// A reference in the file `base`, as GDAL is told it (RFC 3986 for http and https). Throws DataError for one that
/// leads from the network to files of this machine, or is of a kind that is not known.
std::string resolve_stac_reference(const std::string& reference, const std::string& base);

/// The assets of imagery in `places` of the items that STAC files name: an item, a collection of items (GeoJSON, with
/// its next pages), or a catalogue or collection with the items and catalogues that it links to (STAC 1.0 and 1.1,
/// stacspec.org). A file of this machine, "/vsicurl/https://…", or an address, which is read as the latter. Links and
/// references lead from where their file lies; a file of the network leads to no file of this machine. Items outside
/// `bounds` are left out, and so are collections whose extent is.
///
/// `asset`: the key of the assets that are wanted; where it is "" the one with the role "visual", else "data", among
/// those that are rasters by their media type. Throws DataError, naming the file, when it cannot be read or is no STAC,
/// or when there is more of it than the limits above, and UsageError when nothing was named; Interrupted.
StacAssets find_stac_assets(const std::vector<std::string>& places, const DegreeBounds& bounds,
                            const std::string& asset, const Progress& progress = {});

}  // namespace pilotage

#pragma GCC visibility pop
