#pragma once

#include "pilotage/base/options.h"

namespace pilotage {

/// How detectors are trained.
struct TrainOptions {
  int heading_bins = 0;
  int window_px = 45;
  int cell_px = 5;
  int copies = 2;
  int blocks = 4;
  double c = 10;

  template <class Self, class Fields>
  static void describe(Self& self, Fields& fields) {
    fields.field("heading_bins", self.heading_bins,
                 "Headings that have a filter each. 0: one for classes that are round or whose labels are boxes alone, "
                 "8 for others. 1: one for landmarks as they lie, whatever their heading.",
                 Range{0, 32});
    fields.field("window_px", self.window_px, "Side of a detector's window, an odd number of cells.", Range{24, 128});
    fields.field("cell_px", self.cell_px, "Side of a cell of gradient histograms.", Range{4, 16});
    fields.field(
        "copies", self.copies,
        "Degraded copies of each label that are learnt beside it: as another day and another camera might show "
        "it.",
        Range{0, 16});
    fields.field("blocks", self.blocks,
                 "Blocks of ground, each of which is left out once to say how well other ground is found.",
                 Range{2, 16});
    fields.field("c", self.c, "Weight of errors on the training chips against a flat filter.", Range{0.01, 10000});
  }
};

}  // namespace pilotage
