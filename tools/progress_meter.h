#pragma once

#include <chrono>
#include <cstdint>
#include <iosfwd>
#include <string>
#include <string_view>

#include "pilotage/base/options.h"

namespace pilotage {

enum class ProgressMode { kAuto, kNone, kJson };
inline EnumNames<ProgressMode> enum_names(ProgressMode) {
  return {{ProgressMode::kAuto, "auto"}, {ProgressMode::kNone, "none"}, {ProgressMode::kJson, "json"}};
}

enum class ProgressStyle { kNone, kBar, kJson };

/// One line of at most `width` characters: what, a bar, percent, rate and the time that remains at that rate.
/// `per_second` 0: not known yet, and neither is the time.
std::string progress_bar(std::string_view what, std::int64_t done, std::int64_t total, double per_second, int width);

/// Shows progress on a stream, at most ten times a second as a bar that redraws itself and four times as JSON lines
/// (schemas/progress.json); the first and the last report of each kind of work always show as JSON. Rates count from
/// the first report on, so that work that was done before it makes nothing look fast.
class ProgressMeter {
 public:
  /// `width`: columns of the terminal. `escapes`: the terminal understands "erase to the end of the line".
  ProgressMeter(std::ostream& stream, ProgressStyle style, int width, bool escapes);

  void report(std::string_view what, std::int64_t done, std::int64_t total);

  /// A line that shows in every style, at once: as JSON a report of what is done, else `prefix` and the words.
  void say(const std::string& prefix, const std::string& words);

  /// Takes the bar away, so that other lines can be written; as JSON, shows what has not been shown.
  void clear();

 private:
  using Clock = std::chrono::steady_clock;

  void begin(std::string_view what, std::int64_t done);
  void show(Clock::time_point now);
  void finish_lines();
  void draw(const std::string& line);

  std::ostream& stream_;
  ProgressStyle style_;
  int width_;
  bool escapes_;
  std::string what_;
  std::int64_t first_done_ = 0;
  std::int64_t done_ = 0;
  std::int64_t total_ = 0;
  bool pending_ = false;  ///< The last report has not been shown.
  Clock::time_point began_;
  Clock::time_point shown_;
  bool bar_visible_ = false;
};

}  // namespace pilotage
