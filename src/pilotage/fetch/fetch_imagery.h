#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "pilotage/base/options.h"
#include "pilotage/base/progress.h"
#include "pilotage/fetch/stac_assets.h"
#include "pilotage/geo/tile_matrix.h"
#include "pilotage/route/route_options.h"

#pragma GCC visibility push(default)

namespace pilotage {

/// Which imagery of a catalogue is wanted.
struct FetchOptions {
  std::string route;
  RouteOptions route_options;
  std::vector<double> bounds_deg;
  double margin_m = 1000;
  std::string asset;

  template <class Self, class Fields>
  static void describe(Self& self, Fields& fields) {
    fields.path("route", self.route, "Route file: the rectangle around it is fetched.");
    RouteOptions::describe(self.route_options, fields);
    fields.field("bounds_deg", self.bounds_deg,
                 "The rectangle in place of a route: west, south, east, north in degrees (WGS 84).", Range{-180, 180});
    fields.field("margin_m", self.margin_m,
                 "How far around the route: corridor, tile and error together must lie in it.", Range{0, 100000});
    fields.field("asset", self.asset,
                 "Key of the assets to fetch; if not given, the one with the role visual, else data, of each item.");
  }
};

/// A part of a raster that was fetched.
struct FetchedFile {
  std::string name;     ///< In the output folder.
  StacAsset asset;      ///< Where it came from.
  std::string source;   ///< Its dataset without what an address says of who asks: query, name, password.
  std::string version;  ///< Of the raster there (dataset_version).
  PixelWindow window;   ///< Of its pixels.
  std::int64_t bytes = 0;
  std::string digest;  ///< BLAKE2b-256 of the file, 64 hex digits.
  bool kept = false;   ///< It was there already from an earlier run.
};

struct FetchResult {
  DegreeBounds bounds;
  std::vector<FetchedFile> files;     ///< By date: given to `prepare` in this order, later ones lie on top.
  std::vector<std::string> outside;   ///< Items whose rectangle touches the bounds, but not their pixels.
  std::vector<std::string> warnings;  ///< Items left out and why, files of earlier runs, what is odd of the imagery.
};

/// The rectangle of the options. Throws UsageError unless there is either a route or a rectangle, as read_route.
DegreeBounds bounds_of(const FetchOptions& options);

/// The list of what was fetched, in the output folder (schemas/fetched.schema.json).
inline constexpr const char* kFetchedName = "fetched.json";

/// Fetches from the items of STAC catalogues (find_stac_assets) the pixels inside the rectangle, as they are stored,
/// each into a Cloud-Optimised GeoTIFF whose name begins with its date, so that names sort by it (undated ones first),
/// and whose tags say date, licence, attribution and source; and writes fetched.json. May be interrupted at any moment
/// and called again: files that are whole, of the same raster and rectangle, are kept, and so are the rows of the file
/// that was being fetched. Files that earlier runs fetched for other rectangles or catalogues stay, and are warned of.
/// A file of this name that is another one's is replaced only with `overwrite`, an input never; that is asked before
/// anything is fetched. One run at a time works in a folder. Throws UsageError, DataError as find_stac_assets,
/// bounds_of and copy_raster_part, and when imagery cannot be read, changes meanwhile or lies by control points, or
/// nothing lies in the rectangle; Interrupted.
FetchResult fetch_imagery(const std::vector<std::string>& places, const FetchOptions& options,
                          const std::filesystem::path& folder, bool overwrite, const Progress& progress = {});

}  // namespace pilotage

#pragma GCC visibility pop
