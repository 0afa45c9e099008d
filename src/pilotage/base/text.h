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

/// The number that all of `text` spells (surrounding blanks are not allowed), or nothing. Does not depend on the
/// locale.
std::optional<double> parse_number(std::string_view text);

/// The one of `words` that is spelt most like `text` (Levenshtein distance; the first of equals), or "" when none comes
/// near: more than half of its letters would have to change.
std::string nearest_word(std::string_view text, const std::vector<std::string>& words);

/// The text with its first letter as a capital, if that is one of ASCII.
std::string capitalized(std::string text);

std::string join(const std::vector<std::string>& parts, std::string_view separator);

}  // namespace pilotage
