#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

namespace pilotage {

struct BuildStats;

/// "bytes per tile: 25529 of descriptors, 3105 of chips": what a planner weighs against what chips bring.
std::string bytes_per_tile_text(const BuildStats& stats);

/// Adds "descriptor_bytes_per_tile", and when the map has chips "chips" (their number) and "chip_bytes_per_tile".
void add_bytes_per_tile(const BuildStats& stats, nlohmann::ordered_json& json);

/// What a second date made of the features; "" when all were kept.
std::string kept_features_text(const BuildStats& stats);

/// Adds "keep_features" with the numbers of StableStats; nothing when all were kept.
void add_kept_features(const BuildStats& stats, nlohmann::ordered_json& json);

}  // namespace pilotage
