#include "map_delta_result.h"

#include "pilotage/base/text.h"

namespace pilotage {

void add_map_delta(const std::string& old_map, const std::filesystem::path& delta,
                   const std::optional<MapDifference>& difference, CommandResult& result) {
  const auto bytes = std::filesystem::file_size(delta);
  result.text += "delta: " + delta.string() + ", " + format_fixed(static_cast<double>(bytes) / 1e6, 2) + " MB from " +
                 old_map + "; ";
  result.json["delta"] = {{"output", delta.string()}, {"bytes", bytes}};
  const std::string cure = "; --crs, --gsd-m, --tile-size-px and --grid-origin-m of the old plan keep its tiles";
  if (!difference) {
    result.text += "the CRS is another one, so no tile is the same" + cure + "\n";
    return;
  }
  result.text += "tiles: " + std::to_string(difference->same) + " the same, " + std::to_string(difference->changed) +
                 " changed, " + std::to_string(difference->added) + " new, " + std::to_string(difference->removed) +
                 " gone" + (difference->same + difference->changed == 0 ? cure : "") + "\n";
  result.json["delta"]["tiles"] = {{"same", difference->same},
                                   {"changed", difference->changed},
                                   {"added", difference->added},
                                   {"removed", difference->removed}};
}

}  // namespace pilotage
