#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <string_view>

#pragma GCC visibility push(default)

namespace pilotage {

/// A moment to the second, UTC, as files and options state it.
using UtcTime = std::chrono::sys_seconds;

/// The moment that "2026-03-01T06:30:00Z" spells: RFC 3339 in UTC with a Z, whole seconds, years 1970 to 9999. Nothing
/// for any other text, days that the calendar does not have, and leap seconds.
std::optional<UtcTime> parse_utc_time(std::string_view text);

/// The inverse. `time` must be one that parse_utc_time gives.
std::string format_utc_time(UtcTime time);

/// A day, or a moment of one, as imagery and flights are dated.
struct UtcDate {
  UtcTime time;            ///< Of a day alone: its beginning.
  bool has_clock = false;  ///< It is a moment, not a day alone.
};

/// "2026-03-01", years 1826 (the oldest photograph) to 9999, or what parse_utc_time() takes. Nothing for any other
/// text.
std::optional<UtcDate> parse_utc_date(std::string_view text);

/// The same of an option; throws UsageError that names it when it is none.
UtcDate utc_date_of_option(std::string_view option, std::string_view text);

}  // namespace pilotage

#pragma GCC visibility pop
