#include "map_size.h"

#include <algorithm>

#include "pilotage/base/text.h"
#include "pilotage/build_map/build_map.h"

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

std::string kept_features_text(const BuildStats& stats) {
  if (!stats.stable) return "";
  const StableStats& stable = *stats.stable;
  std::string text = "second date: " + std::to_string(stable.survived) + " features confirmed, " +
                     std::to_string(stable.not_known) + " kept without a say, " + std::to_string(stable.dropped) +
                     " dropped";
  if (stable.refilled > 0) {
    text += "; " + std::to_string(stable.refilled) + " more kept in " + std::to_string(stable.tiles_refilled) +
            " tiles that would have fewer than " + std::to_string(kLeastFeatures);
  }
  return text + "\n";
}

void add_kept_features(const BuildStats& stats, nlohmann::ordered_json& json) {
  if (!stats.stable) return;
  json["keep_features"] = {{"survived", stats.stable->survived},
                           {"not_known", stats.stable->not_known},
                           {"dropped", stats.stable->dropped},
                           {"refilled", stats.stable->refilled},
                           {"tiles_refilled", stats.stable->tiles_refilled}};
}

}  // namespace pilotage
