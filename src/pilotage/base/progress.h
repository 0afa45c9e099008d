#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>

#pragma GCC visibility push(default)

namespace pilotage {

/// Called by long work with what it does, how much is done and how much there is in all. Returning false asks the work
/// to stop; it then throws Interrupted and leaves no output behind. May be empty. Calls never overlap.
using Progress = std::function<bool(std::string_view what, std::int64_t done, std::int64_t total)>;

/// The progress callback asked to stop. The command line exits with 130.
struct Interrupted {};

/// Calls `progress` if there is one; throws Interrupted when it asks to stop.
inline void report_progress(const Progress& progress, std::string_view what, std::int64_t done, std::int64_t total) {
  if (progress && !progress(what, done, total)) throw Interrupted{};
}

/// The progress of one part of longer work: says "2 of 5: score" where the part says "score". `part` counts from 1.
inline Progress part_of(const Progress& progress, int part, int parts) {
  if (!progress) return {};
  return [progress, prefix = std::to_string(part) + " of " + std::to_string(parts) + ": "](
             std::string_view what, std::int64_t done, std::int64_t total) {
    return progress(prefix + std::string(what), done, total);
  };
}

}  // namespace pilotage

#pragma GCC visibility pop
