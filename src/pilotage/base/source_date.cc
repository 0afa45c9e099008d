#include "pilotage/base/source_date.h"

#include <charconv>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include "pilotage/base/error.h"

namespace pilotage {

std::optional<UtcTime> source_date() {
  const char* const variable = std::getenv("SOURCE_DATE_EPOCH");
  if (variable == nullptr) return std::nullopt;
  const std::string_view text = variable;
  std::int64_t seconds = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), seconds);
  constexpr std::int64_t kEndOfYear9999 = 253402300799;
  if (error != std::errc{} || end != text.data() + text.size() || seconds < 0 || seconds > kEndOfYear9999) {
    throw UsageError("SOURCE_DATE_EPOCH = \"" + std::string(text) + "\" is not a number of seconds from 0 to " +
                     std::to_string(kEndOfYear9999));
  }
  return UtcTime{std::chrono::seconds(seconds)};
}

}  // namespace pilotage
