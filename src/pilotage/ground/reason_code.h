#pragma once

#include "pilotage/base/options.h"

#pragma GCC visibility push(default)

namespace pilotage {

/// Why a tile is not, or may not be, recognised (docs/methods/reasons.md). The words stand in tiles.csv.
enum class ReasonCode {
  kTooLittleGround,  ///< The imagery covers too little of the tile.
  kFlat,             ///< Hardly any contrast.
  kFewFeatures,      ///< Too few features to be sure of a place.
  kRepeats,          ///< Another place within the search area looks alike.
  kVegetation,       ///< Plants, whose texture changes.
  kWater,            ///< Open water.
  kEdgeOnly,         ///< Structure in one direction only: a fix is good across it, not along it.
  kRelief,           ///< Heights that shift the picture as the point of view moves.
  kCoarse,           ///< A frame shows too few pixels of the map.
  kChanged,          ///< A second date does not agree.
  kWeak,             ///< None of these alone, too little of everything.
};

inline EnumNames<ReasonCode> enum_names(ReasonCode) {
  return {{ReasonCode::kTooLittleGround, "too_little_ground"},
          {ReasonCode::kFlat, "flat"},
          {ReasonCode::kFewFeatures, "few_features"},
          {ReasonCode::kRepeats, "repeats"},
          {ReasonCode::kVegetation, "vegetation"},
          {ReasonCode::kWater, "water"},
          {ReasonCode::kEdgeOnly, "edge_only"},
          {ReasonCode::kRelief, "relief"},
          {ReasonCode::kCoarse, "coarse"},
          {ReasonCode::kChanged, "changed"},
          {ReasonCode::kWeak, "weak"}};
}

}  // namespace pilotage

#pragma GCC visibility pop
