#pragma once

#include <functional>

namespace pilotage {

/// What a long search calls between pieces of work of some milliseconds: it throws to end the search. May be empty.
using Checkpoint = std::function<void()>;

inline void pass(const Checkpoint& checkpoint) {
  if (checkpoint) checkpoint();
}

}  // namespace pilotage
