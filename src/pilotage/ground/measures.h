#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "pilotage/ground/tile_scores.h"

#pragma GCC visibility push(default)

namespace pilotage {

/// What the numbers of a measure are; decides over which range they are coloured and what stands for their unit.
enum class MeasureKind {
  kNumber,       ///< A quantity in its unit, or a plain number.
  kShare,        ///< A share or a probability: 0 … 1.
  kCorrelation,  ///< A normalised cross-correlation or a difference of two: −1 … 1, or −2 … 2.
  kSigmas,       ///< Multiples of a standard deviation.
};

/// What a measure is part of. The report shows its measures in the order of these groups.
enum class MeasureGroup { kCorrectFix, kCoverage, kContrast, kFeatures, kGround, kDegraded, kClean, kSecondDate };

/// Colour maps whose brightness only falls or only grows, so that colour-blind people and paper read them alike. Blues
/// are of measures of which more is better: from pale to the blue in which all maps say "good", and darker, in even
/// steps to the eye; nothing of it reads as caution. Cividis (J. Nuñez, C. Anderton, R. Renslow, PLoS ONE 13(7), 2018)
/// is of all others.
enum class ColorMap { kBlues, kCividis };

/// How a measure is drawn as a heat map.
struct HeatMap {
  int order = 0;        ///< Among the heat maps, ascending, the one to judge by first; 0: it is not drawn.
  std::string title;    ///< For people; where the measure's label does, the same.
  std::string unit;     ///< Of its legend: "NCC", "1" for none.
  std::string meaning;  ///< For people, one or two sentences.
  ColorMap colors = ColorMap::kCividis;
  int decimals = 2;    ///< In the legend.
  bool ranks = false;  ///< Its colours span what the ground has, though it is a share: tiles are told apart by it.
};

/// One measured number of a tile.
struct Measure {
  std::string name;         ///< snake_case with the unit as suffix.
  std::string unit;         ///< "gray levels", "px", or "" for a number without one.
  std::string description;  ///< One line, for the columns of files.
  std::string label;        ///< For people.
  MeasureKind kind = MeasureKind::kNumber;
  MeasureGroup group = MeasureGroup::kContrast;
  int digits = 6;                                ///< Significant ones that tell tiles apart.
  std::function<double(const TileScores&)> get;  ///< NaN = not measured or not defined.
  std::function<void(TileScores&, double)> set;
  HeatMap heat;
};

/// The measures of a tile: the one list from which follow the columns of tiles.csv and of the map's `tiles`, the bands
/// of scores.tif, the shards, the tiles of report.json, the page's heat maps and the styles for QGIS. The order is part
/// of the file formats; a new measure is one more row, at the end.
const std::vector<Measure>& measures();

/// valid_fraction, which is known of every tile before anything is measured. Files hold it before the measures.
const Measure& coverage_measure();

/// The measure of a name (not valid_fraction), or nullptr.
const Measure* find_measure(std::string_view name);

/// The unit as people read it: "NCC" of a correlation, "σ" of sigmas, else `unit`.
std::string shown_unit(const Measure& measure);

/// All measures and the coverage as the report lists them: by group, within a group as in measures().
std::vector<const Measure*> measures_by_group();

/// Those that are drawn, in the order of their heat maps.
std::vector<const Measure*> heat_maps();

}  // namespace pilotage

#pragma GCC visibility pop
