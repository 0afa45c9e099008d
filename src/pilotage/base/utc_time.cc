#include "pilotage/base/utc_time.h"

#include <cstddef>
#include <cstdio>

#include "pilotage/base/error.h"

namespace pilotage {
namespace {

constexpr std::string_view kForm = "0000-00-00T00:00:00Z";  // 0 stands for a digit

constexpr std::size_t kDayLength = 10;

bool has_form(std::string_view text, std::string_view form) {
  if (text.size() != form.size()) return false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool digit = text[i] >= '0' && text[i] <= '9';
    if (form[i] == '0' ? !digit : text[i] != form[i]) return false;
  }
  return true;
}

int digits(std::string_view text, std::size_t at, std::size_t count) {
  int number = 0;
  for (const char c : text.substr(at, count)) number = number * 10 + (c - '0');
  return number;
}

std::chrono::year_month_day day_of(std::string_view text) {
  using namespace std::chrono;
  return {year(digits(text, 0, 4)), month(static_cast<unsigned>(digits(text, 5, 2))),
          day(static_cast<unsigned>(digits(text, 8, 2)))};
}

}  // namespace

std::optional<UtcTime> parse_utc_time(std::string_view text) {
  using namespace std::chrono;
  if (!has_form(text, kForm)) return std::nullopt;
  const year_month_day date = day_of(text);
  const int hour = digits(text, 11, 2);
  const int minute = digits(text, 14, 2);
  const int second = digits(text, 17, 2);
  if (!date.ok() || date.year() < year(1970) || hour > 23 || minute > 59 || second > 59) return std::nullopt;
  return sys_days(date) + hours(hour) + minutes(minute) + seconds(second);
}

std::string format_utc_time(UtcTime time) {
  const auto midnight = std::chrono::floor<std::chrono::days>(time);
  const std::chrono::year_month_day date(midnight);
  const std::chrono::hh_mm_ss clock(time - midnight);
  char buffer[96];
  std::snprintf(buffer, sizeof buffer, "%04d-%02u-%02uT%02d:%02d:%02dZ", static_cast<int>(date.year()),
                static_cast<unsigned>(date.month()), static_cast<unsigned>(date.day()),
                static_cast<int>(clock.hours().count()), static_cast<int>(clock.minutes().count()),
                static_cast<int>(clock.seconds().count()));
  return buffer;
}

std::optional<UtcDate> parse_utc_date(std::string_view text) {
  if (const auto time = parse_utc_time(text)) return UtcDate{*time, true};
  if (!has_form(text, kForm.substr(0, kDayLength))) return std::nullopt;
  const std::chrono::year_month_day date = day_of(text);
  constexpr std::chrono::year kFirstPhotograph(1826);
  if (!date.ok() || date.year() < kFirstPhotograph) return std::nullopt;
  return UtcDate{std::chrono::sys_days(date), false};
}

UtcDate utc_date_of_option(std::string_view option, std::string_view text) {
  if (const auto date = parse_utc_date(text)) return *date;
  throw UsageError(std::string(option) + " = \"" + std::string(text) +
                   "\" is no day as 2023-06-14 and no moment in UTC as 2023-06-14T10:30:00Z");
}

}  // namespace pilotage
