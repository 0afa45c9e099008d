#include "pilotage/ground/measures.h"

#include <algorithm>

namespace pilotage {
namespace {

using Kind = MeasureKind;
using Group = MeasureGroup;

/// A measure without its accessors and, unless `heat` says otherwise, without a heat map. A heat map takes over the
/// label and the unit where it has none of its own.
Measure described(std::string name, std::string unit, std::string description, std::string label, Kind kind,
                  Group group, HeatMap heat) {
  Measure measure;
  measure.name = std::move(name);
  measure.unit = std::move(unit);
  measure.description = std::move(description);
  measure.label = std::move(label);
  measure.kind = kind;
  measure.group = group;
  measure.heat = std::move(heat);
  const std::string shown = shown_unit(measure);
  if (measure.heat.title.empty()) measure.heat.title = measure.label;
  if (measure.heat.unit.empty()) measure.heat.unit = shown.empty() ? "1" : shown;
  return measure;
}

Measure of_tile(std::string name, std::string unit, std::string description, std::string label, Kind kind, Group group,
                double TileScores::*member, HeatMap heat = {}) {
  Measure measure = described(std::move(name), std::move(unit), std::move(description), std::move(label), kind, group,
                              std::move(heat));
  measure.get = [member](const TileScores& score) { return score.*member; };
  measure.set = [member](TileScores& score, double value) { score.*member = value; };
  return measure;
}

/// What the members of a surface are called, whichever surface it is.
struct SurfaceWords {
  std::string name;         ///< "clean_"
  std::string description;  ///< "Clean surface: "
  std::string label;        ///< "Clean: "
  Group group = Group::kClean;
  SurfaceScores TileScores::*surface = nullptr;
};

void add_surface(std::vector<Measure>& list, const SurfaceWords& words, const HeatMap& margin_heat) {
  const auto add = [&](const char* name, const char* unit, const char* description, const char* label, Kind kind,
                       double SurfaceScores::*member, const HeatMap& heat = {}) {
    Measure& measure = list.emplace_back(described(words.name + name, unit, words.description + description,
                                                   words.label + label, kind, words.group, heat));
    const auto surface = words.surface;
    measure.get = [=](const TileScores& score) { return score.*surface.*member; };
    measure.set = [=](TileScores& score, double value) { score.*surface.*member = value; };
  };
  using Surface = SurfaceScores;
  add("peak", "", "correlation at the true position (R1)", "peak R₁", Kind::kCorrelation, &Surface::peak);
  add("rival", "", "highest correlation outside the main lobe (R2)", "rival R₂", Kind::kCorrelation, &Surface::rival);
  add("peak_margin", "", "R1 - R2; negative where a wrong position wins", "R₁ − R₂", Kind::kCorrelation,
      &Surface::margin, margin_heat);
  add("rival_ratio", "", "R2 / R1", "R₂ / R₁", Kind::kNumber, &Surface::rival_ratio);
  add("psr", "", "peak-to-sidelobe ratio, (R1 - mean) / sigma outside the main lobe", "peak to sidelobes",
      Kind::kSigmas, &Surface::psr);
  add("rivals", "", "number of other local maxima of at least 0.8 R1", "rivals above 0.8 R₁", Kind::kNumber,
      &Surface::rivals);
  add("half_width_px", "px", "half width of the main lobe at half its height", "half width", Kind::kNumber,
      &Surface::half_width_px);
  add("expected_error_px", "px", "expected error of a fix per axis, from curvature and noise", "expected error",
      Kind::kNumber, &Surface::expected_error_px);
  add("rival_dx_px", "px", "offset of the strongest rival, to the right", "rival to the right", Kind::kNumber,
      &Surface::rival_dx_px);
  add("rival_dy_px", "px", "offset of the strongest rival, downwards", "rival downwards", Kind::kNumber,
      &Surface::rival_dy_px);
}

void add_second_date(std::vector<Measure>& list) {
  const auto add = [&](const char* name, const char* unit, const char* description, const char* label, Kind kind,
                       double EpochScores::*member, HeatMap heat = {}) {
    Measure& measure =
        list.emplace_back(described(name, unit, std::string("Second date: ") + description,
                                    std::string("Second date: ") + label, kind, Group::kSecondDate, std::move(heat)));
    measure.get = [member](const TileScores& score) { return score.epoch.*member; };
    measure.set = [member](TileScores& score, double value) { score.epoch.*member = value; };
  };
  add("epoch_ncc", "", "correlation of both dates at the registered place", "correlation", Kind::kCorrelation,
      &EpochScores::ncc);
  add("epoch_margin", "", "epoch_ncc - highest correlation at a wrong place", "above the best wrong place",
      Kind::kCorrelation, &EpochScores::margin,
      {12, "Second date: margin", "",
       "Correlation with the registered second date at the true place minus the best wrong place: measured, where "
       "uniqueness is predicted.",
       ColorMap::kBlues, 3});
  add("epoch_survival", "", "share of descriptors found in both dates", "features that stayed", Kind::kShare,
      &EpochScores::survival,
      {13, "", "", "Share of the tile's descriptors found in both dates.", ColorMap::kBlues, 2});
  add("epoch_disagreement_m", "m", "distance between the georeferences of both dates", "georeferences apart",
      Kind::kNumber, &EpochScores::disagreement_m,
      {14, "", "", "Distance between the georeferences of both dates: what a fix may be off even where it is right.",
       ColorMap::kCividis, 1});
}

void add_contrast(std::vector<Measure>& list) {
  list.push_back(
      of_tile("gray_variance", "gray levels", "gray variance V, with the square root", "Gray variance (with the root)",
              Kind::kNumber, Group::kContrast, &TileScores::gray_variance,
              {4, "Gray variance", "",
               "Standard deviation of the gray values (Eq. 1, with the square root): how much contrast there is.",
               ColorMap::kCividis, 1}));
  Measure& entropy = list.emplace_back(of_tile(
      "frieden_entropy", "", "Frieden entropy H", "Frieden entropy", Kind::kNumber, Group::kContrast,
      &TileScores::frieden_entropy,
      {6, "", "",
       "H = Σ p e^(1 − p) (Eq. 2, 3). It saturates just below e = 2.71828…: two tiles differ in the sixth digit.",
       ColorMap::kCividis, 9}));
  entropy.digits = 12;
  list.push_back(of_tile(
      "frieden_deficit", "", "N (1 - H/e) - 1, about (sigma/mean)^2", "Frieden deficit", Kind::kNumber,
      Group::kContrast, &TileScores::frieden_deficit,
      {5, "", "",
       "N (1 − H/e) − 1: the entropy in a scale a person can read; about the squared ratio of contrast to brightness.",
       ColorMap::kCividis, 4}));
}

void add_ground(std::vector<Measure>& list) {
  list.push_back(of_tile(
      "vegetation_share", "", "share of the ground that is green", "Green ground", Kind::kShare, Group::kGround,
      &TileScores::vegetation_share,
      {9, "", "", "Share of the tile that is green: plants look different in another season.", ColorMap::kCividis, 2}));
  list.push_back(of_tile(
      "water_share", "", "share of the ground that looks like open water", "Open water", Kind::kShare, Group::kGround,
      &TileScores::water_share,
      {10, "", "", "Share of the tile that looks like open water: nothing there stays.", ColorMap::kCividis, 2}));
  list.push_back(of_tile("aperture", "", "how much edges run in all directions (1) rather than in one (0)",
                         "Edges: weakest over strongest direction", Kind::kShare, Group::kGround,
                         &TileScores::aperture));
  list.push_back(of_tile("relief_m", "m", "highest minus lowest ground", "Highest minus lowest ground", Kind::kNumber,
                         Group::kGround, &TileScores::relief_m,
                         {11, "Relief", "", "Highest minus lowest ground of the tile.", ColorMap::kCividis, 0}));
}

void add_features(std::vector<Measure>& list) {
  list.push_back(of_tile("map_features", "", "features of the map in this tile", "Features of the map", Kind::kNumber,
                         Group::kFeatures, &TileScores::map_features,
                         {8, "", "features", "Features that the map would hold of the tile.", ColorMap::kCividis, 0}));
  list.push_back(of_tile("vote_noise", "", "standard deviation of the votes that they give to wrong places",
                         "Noise of wrong votes", Kind::kNumber, Group::kFeatures, &TileScores::vote_noise));
  list.push_back(of_tile("fine_contrast", "", "contrast within some 15 px over the median of the imagery's ground",
                         "Fine contrast over the imagery's usual", Kind::kNumber, Group::kFeatures,
                         &TileScores::fine_contrast));
  list.push_back(of_tile(
      "p_correct_fix", "", "probability of a correct fix", "P(correct fix)", Kind::kShare, Group::kCorrectFix,
      &TileScores::p_correct_fix,
      {1, "", "",
       "Probability that the matcher finds a frame taken here on another day, and is right; from one date of imagery. "
       "This is the measure to judge by.",
       ColorMap::kBlues, 2, true}));
  list.push_back(of_tile("level_sigma", "", "standard deviation of the level of the place, logits",
                         "Level of the place: not known better than (logits, 1 sigma)", Kind::kNumber, Group::kFeatures,
                         &TileScores::level_sigma));
  list.push_back(of_tile("level_tiles", "", "tiles of this ground, judged on another date, that the level rests on",
                         "Tiles of this ground that the level rests on", Kind::kNumber, Group::kFeatures,
                         &TileScores::level_tiles));
  list.push_back(of_tile("level_age_months", "months", "time between imagery and flight that P(correct fix) counts",
                         "Age of the imagery that P counts", Kind::kNumber, Group::kFeatures,
                         &TileScores::level_age_months));
}

std::vector<Measure> make_measures() {
  std::vector<Measure> list;
  add_contrast(list);
  add_surface(list, {"clean_", "Clean surface: ", "Clean: ", Group::kClean, &TileScores::clean},
              {3, "Uniqueness, clean", "",
               "Correlation at the true place minus the best rival, the tile matched against its own map. On fine "
               "imagery it is high even over grass and water: do not judge by it alone.",
               ColorMap::kBlues, 3});
  add_surface(list, {"degraded_", "Degraded copies: ", "Degraded: ", Group::kDegraded, &TileScores::degraded},
              {2, "Uniqueness, degraded copies", "",
               "Correlation at the true place minus the best rival in the search area, mean over degraded copies of "
               "the tile. Above 0 the true place wins.",
               ColorMap::kBlues, 3});
  add_second_date(list);
  add_ground(list);
  add_features(list);
  return list;
}

/// Those of a list of all that are wanted, ascending by a key; equal ones stay in order.
template <class Key>
std::vector<const Measure*> sorted_by(Key key) {
  std::vector<const Measure*> list{&coverage_measure()};
  for (const Measure& measure : measures()) list.push_back(&measure);
  std::stable_sort(list.begin(), list.end(), [&](const Measure* a, const Measure* b) { return key(*a) < key(*b); });
  return list;
}

}  // namespace

const std::vector<Measure>& measures() {
  static const std::vector<Measure> list = make_measures();
  return list;
}

const Measure& coverage_measure() {
  static const Measure measure =
      of_tile("valid_fraction", "", "Share of the tile that imagery covers", "Imagery coverage", Kind::kShare,
              Group::kCoverage, &TileScores::valid_fraction,
              {7, "", "", "Share of the tile's pixels that the imagery covers.", ColorMap::kCividis, 3});
  return measure;
}

const Measure* find_measure(std::string_view name) {
  const auto found =
      std::find_if(measures().begin(), measures().end(), [&](const Measure& measure) { return measure.name == name; });
  return found == measures().end() ? nullptr : &*found;
}

std::string shown_unit(const Measure& measure) {
  if (measure.kind == MeasureKind::kCorrelation) return "NCC";
  return measure.kind == MeasureKind::kSigmas ? "σ" : measure.unit;
}

std::vector<const Measure*> measures_by_group() {
  return sorted_by([](const Measure& measure) { return measure.group; });
}

std::vector<const Measure*> heat_maps() {
  std::vector<const Measure*> list = sorted_by([](const Measure& measure) { return measure.heat.order; });
  std::erase_if(list, [](const Measure* measure) { return measure->heat.order == 0; });
  return list;
}

}  // namespace pilotage
