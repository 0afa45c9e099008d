#pragma once

#include <cstdint>
#include <string_view>

namespace pilotage {

/// The bytes that a text stands for: "500000", "20MB" (10^6), "20 MiB" (2^20), likewise kB/KiB and GB/GiB; case does
/// not matter. Throws UsageError when the text is none of these, not positive or above 2^53.
std::int64_t parse_byte_budget(std::string_view text);

}  // namespace pilotage
