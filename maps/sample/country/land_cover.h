#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace pilotage {

/// What the ground of a synthetic scene is, seen from above.
enum class LandCover : std::uint8_t {
  kField = 0,     ///< Arable land, whatever grows or does not grow on it at the date.
  kGrass = 1,     ///< Meadows, lawns and gardens.
  kBare = 2,      ///< Pits, yards of trodden earth, building sites.
  kRoad = 3,      ///< Asphalt: roads, streets.
  kTrack = 4,     ///< Sandy tracks.
  kRoof = 5,      ///< Buildings.
  kPavement = 6,  ///< Concrete and paving: yards, car parks, footways.
  kOrchard = 7,   ///< Fruit trees in rows, and the grass between them.
  kForest = 8,
  kTree = 9,  ///< Single trees and hedges.
  kWater = 10,
  kBank = 11,     ///< Sand and reeds along water.
  kVehicle = 12,  ///< Cars and lorries.
};

constexpr int kLandCoverCount = 13;

constexpr std::array<std::string_view, kLandCoverCount> kLandCoverNames = {
    "field",   "grass",  "bare", "road",  "track", "roof",   "pavement",
    "orchard", "forest", "tree", "water", "bank",  "vehicle"};

}  // namespace pilotage
