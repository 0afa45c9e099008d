#include "pilotage/route/route_size.h"

#include <algorithm>
#include <cstddef>

#include "pilotage/base/error.h"
#include "pilotage/route/read_route.h"

namespace pilotage {
namespace {

/// Numbers, tags and texts for each position: more than any program writes.
constexpr std::size_t kMaxValues = 40 * kMaxRouteVertices;

std::size_t count(std::string_view text, char mark) {
  return static_cast<std::size_t>(std::count(text.begin(), text.end(), mark));
}

std::size_t count(std::string_view text, std::string_view mark) {
  std::size_t found = 0;
  for (std::size_t at = text.find(mark); at != std::string_view::npos; at = text.find(mark, at + mark.size())) ++found;
  return found;
}

void check_value_count(const std::string& name, std::size_t values) {
  if (values <= kMaxValues) return;
  throw DataError(name + ": holds " + std::to_string(values) + " values, a route file at most " +
                  std::to_string(kMaxValues) + "; leave out what is not flown");
}

/// Attributes of an element, as far as the marks between two "<" tell: parsers keep all of them until the element
/// begins.
void check_attribute_count(const std::string& name, std::string_view text) {
  constexpr std::size_t kMostAttributes = 10'000;
  std::size_t marks = 0;
  for (const char c : text) {
    if (c == '<') marks = 0;
    if (c == '=' && ++marks > kMostAttributes) {
      throw DataError(name + ": has an element of more than " + std::to_string(kMostAttributes) + " attributes");
    }
  }
}

}  // namespace

void check_position_count(const std::string& name, std::size_t positions) {
  if (positions <= kMaxRouteVertices) return;
  throw DataError(name + ": has " + std::to_string(positions) + " positions or more, a route at most " +
                  std::to_string(kMaxRouteVertices) + "; thin it out, for instance with ogr2ogr -simplify");
}

void check_json_route_size(const std::string& name, std::string_view text) {
  // A position is a list that begins with a number: "[16.5, 55.5]".
  std::size_t positions = 0;
  for (std::size_t at = text.find('['); at != std::string_view::npos; at = text.find('[', at + 1)) {
    const std::size_t first = text.find_first_not_of(" \t\r\n", at + 1);
    if (first != std::string_view::npos && (text[first] == '-' || (text[first] >= '0' && text[first] <= '9'))) {
      ++positions;
    }
  }
  check_position_count(name, positions);
  check_value_count(name, count(text, ',') + count(text, '[') + count(text, '{'));
}

void check_gpx_size(const std::string& name, std::string_view text) {
  check_attribute_count(name, text);
  check_position_count(name, count(text, "lat="));
  check_value_count(name, count(text, '<'));
}

void check_kml_size(const std::string& name, std::string_view text) {
  check_attribute_count(name, text);
  check_position_count(name, count(text, ',') / 2);  // "16.5,55.5,120"; "16.5,55.5" counts half
  check_value_count(name, count(text, '<') + count(text, ','));
}

void check_wpl_size(const std::string& name, std::string_view text) {
  check_position_count(name, count(text, '\n'));  // one item a line
}

}  // namespace pilotage
