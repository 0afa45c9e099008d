#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "pilotage/route/ogr_route.h"
#include "pilotage/route/route_line.h"

// Private to route/ogr_*.cc.

namespace pilotage {

/// Which positions of a file have a height, by its text: where one of a line has, OGR gives 0 to those that have none.
/// Of KML and GeoJSON; other formats tell it themselves.
class WrittenHeights {
 public:
  /// `name` stands in messages; of a KMZ the bytes are those of its document. They must outlive the object.
  WrittenHeights(std::string name, std::string_view bytes, OgrFormat format)
      : name_(std::move(name)), bytes_(bytes), format_(format) {}

  /// Makes NaN the heights of 0 that are not written, of a line as OGR read it, in the file's own coordinates. Reads
  /// the text when it is first needed; throws DataError when it is not well formed.
  void apply(std::vector<LinePoint>& points);

 private:
  struct WrittenLine {
    std::vector<LinePoint> points;
    bool taken = false;
  };

  void read();

  std::string name_;
  std::string_view bytes_;
  OgrFormat format_;
  std::optional<std::vector<WrittenLine>> lines_;  ///< Those of which a position has no height.
};

}  // namespace pilotage
