#include "describe_commands.h"

#include "common_options.h"
#include "option_text.h"
#include <nlohmann/json.hpp>

#include "pilotage/base/variant_json.h"
#include "pilotage/version.h"

namespace pilotage {
namespace {

using Json = nlohmann::ordered_json;

const char* type_name(OptionType type) {
  switch (type) {
    case OptionType::kBool:
      return "boolean";
    case OptionType::kInteger:
      return "integer";
    case OptionType::kNumber:
      return "number";
    case OptionType::kNumberList:
      return "numbers";
    case OptionType::kStringList:
      return "texts";
    case OptionType::kString:
      break;
  }
  return "text";
}

const char* kind_name(OutputKind kind) {
  switch (kind) {
    case OutputKind::kFile:
      return "file";
    case OutputKind::kFolder:
      return "folder";
    case OutputKind::kNone:
      break;
  }
  return "none";
}

Json field_json(const OptionField& field) {
  Json option = {{"name", field.path},
                 {"flag", "--" + field.flag},
                 {"type", type_name(field.type)},
                 {"path", field.is_path},
                 {"help", field.help}};
  if (const std::string unit = unit_of(field); !unit.empty()) option["unit"] = unit;
  if (field.range) {
    option["minimum"] = field.range->min;
    option["maximum"] = field.range->max;
  }
  if (!field.choices.empty()) option["choices"] = field.choices;
  option["default"] = variant_to_json(field.default_value);
  return option;
}

Json section_json(const OptionList& list, const std::string& heading, const std::string& group) {
  Json section = {{"heading", heading}, {"options", Json::array()}};
  for (const OptionField& field : list.fields) {
    if (!field.flag.empty() && group_of(field) == group) section["options"].push_back(field_json(field));
  }
  return section;
}

Json command_json(const Command& command) {
  Json described = {{"word", command.word},
                    {"summary", command.summary},
                    {"usage", usage_of(command)},
                    {"examples", Json::array()},
                    {"inputs",
                     {{"name", command.inputs.name},
                      {"help", command.inputs.help},
                      {"min", command.inputs.min},
                      {"max", command.inputs.max == InputSpec::kMany ? Json(nullptr) : Json(command.inputs.max)},
                      {"is_config", command.inputs.is_config}}},
                    {"output",
                     {{"kind", kind_name(command.output.kind)},
                      {"help", command.output.help},
                      {"required", command.output.required && command.output.kind != OutputKind::kNone}}},
                    {"sections", Json::array()}};
  for (const CommandExample& example : command.examples) {
    described["examples"].push_back({{"what", example.what}, {"line", example.line}});
  }
  const auto add_section = [&](Json section) {
    if (!section["options"].empty()) described["sections"].push_back(std::move(section));
  };
  add_section(section_json(command.options, "", ""));
  for (const OptionGroup& group : command.options.groups) {
    add_section(section_json(command.options, group.help, group.path));
  }
  CommonOptions common;
  add_section(section_json(common_fields_for(command, common), "What every command takes.", ""));
  return described;
}

}  // namespace

Json describe_commands(const std::vector<Command>& commands) {
  Json described = {{"version", PILOTAGE_VERSION}, {"commands", Json::array()}};
  for (const Command& command : commands) {
    if (command.group != CommandGroup::kHelp) described["commands"].push_back(command_json(command));
  }
  return described;
}

}  // namespace pilotage
