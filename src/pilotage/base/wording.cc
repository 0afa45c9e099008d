#include "pilotage/base/wording.h"

#include <algorithm>
#include <cmath>

#include "pilotage/base/text.h"

namespace pilotage {
namespace {

// The word for what is no finite number, else "".
std::string word_for(double number) {
  if (std::isnan(number)) return "unknown";
  return std::isinf(number) ? "unbounded" : "";
}

int error_decimals(double error_m) {
  return std::abs(error_m) < 9.95 ? 1 : 0;
}

}  // namespace

std::string length_text(double length_m) {
  if (const std::string word = word_for(length_m); !word.empty()) return word;
  return length_m >= 999.5 ? format_fixed(length_m / 1000, 1) + " km" : format_fixed(length_m, 0) + " m";
}

std::string error_text(double error_m) {
  if (const std::string word = word_for(error_m); !word.empty()) return word;
  return format_fixed(error_m, error_decimals(error_m)) + " m";
}

std::string comparison_text(double error_m, double limit_m) {
  const std::string sign = error_m <= limit_m ? " ≤ " : " > ";
  if (!std::isfinite(error_m) || !std::isfinite(limit_m)) return error_text(error_m) + sign + error_text(limit_m);
  int decimals = error_decimals(std::min(error_m, limit_m));
  while (decimals < 6 && error_m != limit_m && format_fixed(error_m, decimals) == format_fixed(limit_m, decimals)) {
    ++decimals;
  }
  return format_fixed(error_m, decimals) + " m" + sign + format_fixed(limit_m, decimals) + " m";
}

std::string duration_text(double duration_s) {
  if (const std::string word = word_for(duration_s); !word.empty()) return word;
  const double whole_s = std::round(duration_s);
  if (whole_s < 600) return format_fixed(whole_s, 0) + " s";
  return format_fixed(std::floor(whole_s / 60), 0) + " min " + format_fixed(std::fmod(whole_s, 60), 0) + " s";
}

std::string percent_text(double fraction) {
  if (!std::isfinite(fraction)) return "unknown";
  if (fraction > 0 && fraction < 0.01) return "less than 1 %";
  return format_fixed(std::floor(fraction * 100 + 1e-9), 0) + " %";
}

std::string bytes_text(double bytes) {
  if (!std::isfinite(bytes)) return "unknown";
  if (bytes < 1024) return format_fixed(bytes, 0) + " bytes";
  if (bytes < 1024.0 * 1024) return format_fixed(bytes / 1024, 1) + " KiB";
  return format_fixed(bytes / (1024.0 * 1024), 1) + " MiB";
}

std::string count_text(std::int64_t count, const std::string& one, const std::string& many) {
  return std::to_string(count) + " " + (count == 1 ? one : many);
}

std::string months_text(double months) {
  return count_text(std::llround(months), "month", "months");
}

std::string signed_text(double number, int decimals) {
  const std::string text = format_fixed(std::abs(number), decimals);
  const bool is_nothing = text.find_first_of("123456789") == std::string::npos;
  return (number < 0 && !is_nothing ? "−" : "+") + text;
}

std::string listed(const std::vector<std::string>& words) {
  if (words.size() < 2) return join(words, "");
  return join({words.begin(), words.end() - 1}, ", ") + " and " + words.back();
}

std::string number_text(double number, int decimals) {
  return std::isfinite(number) ? format_fixed(number, decimals) : "–";
}

}  // namespace pilotage
