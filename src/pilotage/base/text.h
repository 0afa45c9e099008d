#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace pilotage {

/// The shortest decimal text that reads back as exactly `number`; "nan", "inf" and "-inf" for what is not finite.
/// Does not depend on the locale.
std::string format_number(double number);

/// `number` with `decimals` digits after the point, for people; does not depend on the locale.
std::string format_fixed(double number, int decimals);

/// The number that all of `text` spells (surrounding blanks are not allowed), or nothing. Does not depend on the locale.
std::optional<double> parse_number(std::string_view text);

std::string join(const std::vector<std::string>& parts, std::string_view separator);

}  // namespace pilotage
