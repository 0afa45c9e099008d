#include "spread_output.h"

#include <cmath>

#include "pilotage/base/json_object.h"
#include "pilotage/base/text.h"

namespace pilotage {

std::string spread_text(const Spread& spread) {
  if (std::isnan(spread.median)) return "not known";
  return format_fixed(spread.median, 2) + " m median, " + format_fixed(spread.quantile_95, 2) + " m 95 %, " +
         format_fixed(spread.largest, 2) + " m largest";
}

nlohmann::ordered_json spread_json(const Spread& spread) {
  return {{"median", json_number(spread.median)},
          {"quantile_95", json_number(spread.quantile_95)},
          {"largest", json_number(spread.largest)}};
}

}  // namespace pilotage
