#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "pilotage/base/error.h"
#include "pilotage/route/route.h"
#include "pilotage/route/route_options.h"

namespace pilotage {

/// Reads a route: QGroundControl .plan and .mission, QGC WPL 110, DJI missions (KMZ, .wpml), Litchi CSV, UgCS JSON or
/// CSV, KML, KMZ, GPX, GeoJSON or GeoPackage, told apart by content and not by extension. Every assumption made stands
/// in Route::notes and the fate of each item in Route::items.
///
/// Throws UsageError for options outside their range, and DataError naming the file and the item when the file cannot
/// be read or is none of these formats; is of a wrong version or fileType; has fewer than two positions; has a latitude
/// outside [-90, 90], a longitude outside [-180, 180] or a number that is not finite; has heights relative to a home
/// that it does not name; uses a local coordinate frame; or is larger than the limits below, which are estimated before
/// anything is parsed.
Route read_route(const std::filesystem::path& path, const RouteOptions& options = {});

/// One of several lines of a file, any of which could be the route.
struct RouteChoice {
  std::string layer;
  std::string name;
  std::string what;  ///< "line", "route", "track", "points"
  std::size_t points = 0;
};

/// What reading a file with several lines throws while the options choose none of them.
class SeveralRoutesError : public DataError {
 public:
  SeveralRoutesError(const std::string& message, std::vector<RouteChoice> choices)
      : DataError(message), choices_(std::move(choices)) {}

  /// In the order of their numbers (RouteOptions::feature), which count from 1.
  const std::vector<RouteChoice>& choices() const { return choices_; }

 private:
  std::vector<RouteChoice> choices_;
};

/// The same from the bytes of a file; `name` stands in messages and becomes Route::name. Survives any bytes.
Route parse_route(const std::string& name, std::string_view bytes, const RouteOptions& options = {});

/// Largest route file that is read, unpacked; far above any mission, and below what would exhaust memory.
inline constexpr std::size_t kMaxRouteBytes = std::size_t{64} << 20;

/// Most vertices that a route may have: 28 hours of a track with one point a second.
inline constexpr std::size_t kMaxRouteVertices = 100'000;

}  // namespace pilotage
