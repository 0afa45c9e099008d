#pragma once

#include <string>

#include <nlohmann/json.hpp>
#include <valijson/adapters/nlohmann_json_adapter.hpp>
#include <valijson/schema.hpp>
#include <valijson/schema_parser.hpp>
#include <valijson/validator.hpp>

#include "pilotage/base/output_file.h"

namespace pilotage::testing {

/// The first violation of a schema of ours, "report.schema.json", or "".
inline std::string schema_violation(const std::string& schema_name, const nlohmann::ordered_json& json) {
  using Adapter = valijson::adapters::NlohmannJsonAdapter;
  const auto schema_json =
      nlohmann::json::parse(read_file(std::string(PILOTAGE_SOURCE_DIR) + "/schemas/" + schema_name));
  valijson::Schema schema;
  valijson::SchemaParser parser;
  parser.populateSchema(Adapter(schema_json), schema);
  const auto plain = nlohmann::json::parse(json.dump());
  const Adapter target(plain);
  valijson::Validator validator;
  valijson::ValidationResults results;
  if (validator.validate(schema, target, &results)) return "";
  valijson::ValidationResults::Error error;
  results.popError(error);
  std::string text;
  for (const std::string& part : error.context) text += part;
  return text + ": " + error.description;
}

}  // namespace pilotage::testing
