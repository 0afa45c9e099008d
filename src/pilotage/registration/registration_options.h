#pragma once

#include <optional>

#include "pilotage/base/options.h"

#pragma GCC visibility push(default)

namespace pilotage {

/// What of the ground is correlated.
enum class TieShadows { kIgnore, kFollow };

inline EnumNames<TieShadows> enum_names(TieShadows) {
  return {{TieShadows::kIgnore, "ignore"}, {TieShadows::kFollow, "follow"}};
}

/// How ties between two dates are looked for on one grid (ties.h).
struct TieOptions {
  int template_px = 96;
  int spacing_px = 32;
  double min_ncc = 0.3;
  double min_margin = 0.03;
  double max_backward_px = 1;
  double min_valid_fraction = 0.7;
  TieShadows shadows = TieShadows::kIgnore;

  template <class Self, class Fields>
  static void describe(Self& self, Fields& fields) {
    fields.field("template_px", self.template_px, "Side of the square that is correlated.", Range{16, 512});
    fields.field("spacing_px", self.spacing_px, "Distance between neighbouring places.", Range{4, 4096});
    fields.field("min_ncc", self.min_ncc, "Ties that correlate less are dropped.", Range{0, 1});
    fields.field("min_margin", self.min_margin, "Ties whose correlation exceeds the best rival's by less are dropped.",
                 Range{0, 2});
    fields.field("max_backward_px", self.max_backward_px,
                 "A tie looked for backwards, from the second date, must come back within this.", Range{0.1, 16});
    fields.field("min_valid_fraction", self.min_valid_fraction, "Least share of ground in a square, in both dates.",
                 Range{0.1, 1});
    fields.field(
        "shadows", self.shadows,
        "What is darker than its surroundings, most of it shadows, on pixels below 2 m: ignore leaves it out, for with "
        "the sun "
        "elsewhere shadows fall another way; follow correlates it, too: more ties between dates of like light.");
  }
};

/// How a warp is fitted to ties (fit_warp.h). Lengths in pixels of the finest ties; those of a tie in its own pixels.
struct WarpOptions {
  double control_spacing_px = 96;
  double tie_sigma_px = 0.5;
  double bending_px = 2;
  double reach_px = 64;

  template <class Self, class Fields>
  static void describe(Self& self, Fields& fields) {
    fields.field("control_spacing_px", self.control_spacing_px, "Distance between the warp's control points.",
                 Range{8, 100000});
    fields.field("tie_sigma_px", self.tie_sigma_px,
                 "Expected error of a good tie, in its own pixels; worse ones count less and less.", Range{0.01, 100});
    fields.field("bending_px", self.bending_px,
                 "How much the displacement is expected to bend from one control point to the next.",
                 Range{0.0001, 1000});
    fields.field("reach_px", self.reach_px,
                 "The warp is known where at least three good ties are this near, in their own pixels.",
                 Range{8, 100000});
  }
};

/// How a second date is brought onto the reference (register_dates.h).
struct RegistrationOptions {
  double search_radius_m = 30;
  std::optional<double> gsd_m;
  TieOptions ties;
  WarpOptions warp;

  template <class Self, class Fields>
  static void describe(Self& self, Fields& fields) {
    fields.field("search_radius_m", self.search_radius_m,
                 "Largest disagreement of both georeferences, along each axis, that is looked for.", Range{0.1, 10000});
    fields.field("gsd_m", self.gsd_m,
                 "Ground sample distance to correlate at; default: 0.6 m, or that of the coarser date when it is "
                 "coarser.",
                 Range{0.001, 10000});
    fields.group("ties", self.ties, "How ties are looked for.");
    fields.group("warp", self.warp, "How the warp is fitted to them.");
  }
};

}  // namespace pilotage

#pragma GCC visibility pop
