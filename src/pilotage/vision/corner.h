#pragma once

namespace pilotage {

/// A corner: whole pixel, and its Harris response.
struct Corner {
  int x = 0;
  int y = 0;
  float response = 0;
};

}  // namespace pilotage
