#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json_fwd.hpp>

namespace pilotage {

/// valid_utf8 (base/utf8.h) of every string and key in `json`.
nlohmann::ordered_json valid_utf8_json(const nlohmann::ordered_json& json);

/// JSON for the inside of a <script> element: no `<`, `>`, `&`, U+2028 or U+2029 stands in it unescaped, so that no
/// string can close the element. It parses to the same value. Strings must be valid UTF-8.
std::string script_json(const nlohmann::ordered_json& json);

/// RFC 4648 with padding, for data: addresses.
std::string base64(std::string_view bytes);

/// Of the numbers' bytes, little-endian, so that none of their digits is lost.
std::string base64_doubles(const std::vector<double>& numbers);

/// Replaces each `{{name}}` of `page` by its value, in one pass: what a value holds is never expanded again. Throws
/// std::logic_error when a name of the page has no value.
std::string fill_template(std::string_view page, const std::map<std::string, std::string, std::less<>>& values);

}  // namespace pilotage
