#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "command.h"

#include "pilotage/mapdb/map_delta_writer.h"

namespace pilotage {

inline constexpr const char* kUpdateHelp =
    "The map that is there: also write what turns it into the new one (NEW.delta, for `pilotage update`).";

/// Says what --update wrote, and what became of the tiles: a line, and "delta".
void add_map_delta(const std::string& old_map, const std::filesystem::path& delta,
                   const std::optional<MapDifference>& difference, CommandResult& result);

}  // namespace pilotage
