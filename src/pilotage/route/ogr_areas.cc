#include "pilotage/route/ogr_areas.h"

#include <string>
#include <utility>

#include "pilotage/base/error.h"
#include "pilotage/base/utf8.h"
#include "pilotage/route/ogr_shapes.h"
#include "pilotage/route/route_size.h"

namespace pilotage {

std::vector<GeodeticArea> read_areas(const std::filesystem::path& path) {
  std::vector<GeodeticArea> areas;
  std::size_t corners = 0;
  int others = 0;
  for (GeodeticShape& shape : read_shapes(path)) {
    if (shape.kind != ShapeKind::kPolygon) {
      ++others;
      continue;
    }
    if (!shape.problem.empty()) throw DataError(shape.name + ": " + shape.problem);
    for (const auto& ring : shape.rings) check_position_count(name_as_utf8(path.string()), corners += ring.size());
    areas.push_back({std::move(shape.rings)});
  }
  if (areas.empty()) {
    throw DataError(name_as_utf8(path.string()) + ": holds no polygon" +
                    (others > 0 ? ", but " + std::to_string(others) + " other shapes, as lines or points" : ""));
  }
  return areas;
}

}  // namespace pilotage
