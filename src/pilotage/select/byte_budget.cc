#include "pilotage/select/byte_budget.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <string>
#include <utility>

#include "pilotage/base/error.h"
#include "pilotage/base/text.h"

namespace pilotage {

std::int64_t parse_byte_budget(std::string_view text) {
  static constexpr std::pair<std::string_view, double> kUnits[] = {
      {"", 1}, {"b", 1}, {"kb", 1e3}, {"kib", 1024.0}, {"mb", 1e6}, {"mib", 0x1p20}, {"gb", 1e9}, {"gib", 0x1p30}};
  const auto unit_at = std::min(text.find_first_not_of("0123456789."), text.size());
  std::string unit(text.substr(unit_at));
  unit.erase(0, unit.find_first_not_of(' ') == std::string::npos ? unit.size() : unit.find_first_not_of(' '));
  std::transform(unit.begin(), unit.end(), unit.begin(), [](unsigned char c) { return std::tolower(c); });
  const auto* const known =
      std::find_if(std::begin(kUnits), std::end(kUnits), [&](const auto& entry) { return entry.first == unit; });
  const auto number = parse_number(text.substr(0, unit_at));
  if (number && known != std::end(kUnits)) {
    const double bytes = *number * known->second;
    if (bytes >= 1 && bytes <= 0x1p53) return static_cast<std::int64_t>(bytes);
  }
  throw UsageError("budget = \"" + std::string(text) +
                   "\" is not a number of bytes; allowed are 1 to 2^53 as in 500000, 20MB, 20MiB, 1.5GiB");
}

}  // namespace pilotage
