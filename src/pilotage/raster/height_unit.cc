#include "pilotage/raster/height_unit.h"

#include <algorithm>
#include <cctype>
#include <string_view>
#include <vector>

namespace pilotage {
namespace {

/// The name of a unit in small letters and figures, a blank for everything else: "US_survey_foot" is "us survey foot".
std::string plain_unit(const std::string& unit) {
  std::string plain;
  for (const char c : unit) {
    const auto letter = static_cast<unsigned char>(c);
    const bool kept = std::isalnum(letter) != 0;
    if (kept) plain += static_cast<char>(std::tolower(letter));
    if (!kept && !plain.empty() && plain.back() != ' ') plain += ' ';
  }
  if (plain.ends_with(' ')) plain.pop_back();
  return plain;
}

/// A unit of height, metres in it (EPSG's figures), and how it is spelt by those who write rasters.
struct HeightUnit {
  double metres;
  std::vector<std::string_view> names;
};

const std::vector<HeightUnit>& height_units() {
  static const std::vector<HeightUnit> units = {
      {1, {"", "m", "metre", "meter", "metres", "meters"}},
      {0.3048,
       {"ft", "foot", "feet", "foot international", "feet international", "ft international", "international foot",
        "international feet", "intl foot", "intl feet", "intl ft", "foot intl", "feet intl", "ft intl"}},
      {1200.0 / 3937.0, {"us ft",           "usft",           "ft us",           "ftus",
                         "us foot",         "us feet",        "foot us",         "feet us",
                         "us survey foot",  "us survey feet", "us survey ft",    "survey foot",
                         "survey feet",     "survey ft",      "foot us survey",  "feet us survey",
                         "ft us survey",    "ussurveyfoot",   "u s survey foot", "u s survey feet",
                         "foot u s survey", "foot u s",       "feet u s",        "u s foot",
                         "u s feet",        "foot survey us"}},
      {0.3047972654, {"clarke s foot", "clarke foot", "foot clarke", "clarke s feet"}},
      {0.304799514, {"indian foot", "indian feet", "ind ft", "foot indian"}},
      {0.304799472, {"british foot sears 1922", "british foot", "foot british"}},
      {0.9144, {"yd", "yard", "yards"}},
      {0.1, {"dm", "decimetre", "decimeter", "decimetres", "decimeters"}},
      {0.01, {"cm", "centimetre", "centimeter", "centimetres", "centimeters"}},
      {0.001, {"mm", "millimetre", "millimeter", "millimetres", "millimeters"}},
      {1000, {"km", "kilometre", "kilometer", "kilometres", "kilometers"}}};
  return units;
}

}  // namespace

std::optional<double> metres_per_height_unit(const std::string& unit) {
  const std::string plain = plain_unit(unit);
  for (const HeightUnit& known : height_units()) {
    if (std::find(known.names.begin(), known.names.end(), plain) != known.names.end()) return known.metres;
  }
  return std::nullopt;
}

}  // namespace pilotage
