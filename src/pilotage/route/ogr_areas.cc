#include "pilotage/route/ogr_areas.h"

#include <string>
#include <utility>

#include "pilotage/base/error.h"
#include "pilotage/base/utf8.h"
#include "pilotage/route/ogr_shapes.h"

namespace pilotage {

std::vector<GeodeticArea> read_areas(const std::filesystem::path& path) {
  std::vector<GeodeticArea> areas;
  int others = 0;
  for (GeodeticShape& shape : read_shapes(path)) {
    if (shape.kind == ShapeKind::kPolygon) {
      areas.push_back({std::move(shape.rings)});
    } else {
      ++others;
    }
  }
  if (areas.empty()) {
    throw DataError(name_as_utf8(path.string()) + ": holds no polygon" +
                    (others > 0 ? ", but " + std::to_string(others) + " other shapes, as lines or points" : ""));
  }
  return areas;
}

}  // namespace pilotage
