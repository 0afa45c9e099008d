#include "map_size.h"

#include <algorithm>

#include "pilotage/base/text.h"
#include "pilotage/build/build_map.h"

namespace pilotage {
namespace {

double per_tile(std::int64_t bytes, const BuildStats& stats) {
  return static_cast<double>(bytes) / static_cast<double>(std::max<std::int64_t>(1, stats.tiles));
}

}  // namespace

std::string bytes_per_tile_text(const BuildStats& stats) {
  std::string text = "bytes per tile: " + format_fixed(per_tile(stats.descriptor_bytes, stats), 0) + " of descriptors";
  if (stats.chips > 0) text += ", " + format_fixed(per_tile(stats.chip_bytes, stats), 0) + " of chips";
  return text + "\n";
}

void add_bytes_per_tile(const BuildStats& stats, nlohmann::ordered_json& json) {
  json["descriptor_bytes_per_tile"] = per_tile(stats.descriptor_bytes, stats);
  if (stats.chips == 0) return;
  json["chips"] = stats.chips;
  json["chip_bytes_per_tile"] = per_tile(stats.chip_bytes, stats);
}

}  // namespace pilotage
