#include "pilotage/mission/licence_json.h"

#include <nlohmann/json.hpp>

namespace pilotage {

void add_licence(const Licence& licence, nlohmann::ordered_json& json, const std::string& prefix) {
  if (!licence.terms.empty()) json[prefix + "licence"] = licence.terms;
  if (!licence.attribution.empty()) json[prefix + "attribution"] = licence.attribution;
}

Licence licence_from_json(JsonObject& object, const std::string& prefix) {
  Licence licence;
  if (object.has(prefix + "licence")) licence.terms = object.text(prefix + "licence");
  if (object.has(prefix + "attribution")) licence.attribution = object.text(prefix + "attribution");
  return licence;
}

}  // namespace pilotage
