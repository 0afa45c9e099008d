#include "testing/json_schema.h"

#include <filesystem>
#include <memory>

#include "testing/source_folder.h"
#include <nlohmann/json.hpp>
#include <valijson/adapters/nlohmann_json_adapter.hpp>
#include <valijson/schema.hpp>
#include <valijson/schema_parser.hpp>
#include <valijson/validator.hpp>

#include "pilotage/base/output_file.h"

namespace pilotage::testing {
namespace {

using nlohmann::json;

const std::string kScheme = "schema://";

/// valijson resolves relative references against nothing, and keeps what it has read under the reference's text. So
/// every reference is spelt out, with the file that it means.
void spell_out_references(json& node, const std::string& name) {
  if (node.is_object() && node.contains("$ref") && node["$ref"].is_string()) {
    const std::string reference = node["$ref"];
    const auto hash = std::min(reference.find('#'), reference.size());
    const std::string file = reference.substr(0, hash);
    const std::string target =
        file.empty() ? name : (std::filesystem::path(name).parent_path() / file).lexically_normal().string();
    node["$ref"] = kScheme + target + reference.substr(hash);
  }
  for (json& child : node) {
    if (child.is_structured()) spell_out_references(child, name);
  }
}

json read_schema(const std::string& name) {
  json schema = json::parse(read_file(testing::source_folder() / ("schemas/" + name)));
  schema.erase("$id");
  spell_out_references(schema, name);
  return schema;
}

}  // namespace

std::string schema_violation(const std::string& schema_name, const nlohmann::ordered_json& value) {
  using Adapter = valijson::adapters::NlohmannJsonAdapter;
  const json schema_json = read_schema(schema_name);
  valijson::Schema schema;
  valijson::SchemaParser parser;
  parser.populateSchema(
      Adapter(schema_json), schema,
      [](const std::string& uri) -> const json* { return new json(read_schema(uri.substr(kScheme.size()))); },
      [](const json* document) { delete document; });
  const json plain = json::parse(value.dump());
  const Adapter target(plain);
  valijson::Validator validator;
  valijson::ValidationResults results;
  if (validator.validate(schema, target, &results)) return "";
  std::string text;
  valijson::ValidationResults::Error error;
  while (results.popError(error)) {
    text += text.empty() ? "" : "; ";
    for (const std::string& part : error.context) text += part;
    text += ": " + error.description;
  }
  return text;
}

}  // namespace pilotage::testing
