#include "common_options.h"

#include <algorithm>
#include <filesystem>

namespace pilotage {

OptionList common_fields_for(const Command& command, CommonOptions& common) {
  OptionList list = list_options(common);
  std::erase_if(list.fields, [&](const OptionField& field) {
    if (command.output.kind == OutputKind::kNone && (field.flag == "output" || field.flag == "overwrite")) return true;
    const bool of_rasters =
        field.flag == "allow-network" || field.flag == "allow-any-vrt" || field.flag == "gdal-driver";
    if (of_rasters && !command.reads_rasters) return true;
    return std::any_of(command.options.fields.begin(), command.options.fields.end(),
                       [&](const OptionField& own) { return own.flag == field.flag; });
  });
  for (OptionField& field : list.fields) {
    if (field.flag != "output") continue;
    if (!command.output.help.empty()) field.help = command.output.help;
    const std::filesystem::path printed = command.output.stream_name;
    if (!printed.empty()) field.help += " \"-\" prints the " + printed.extension().string() + ".";
  }
  return list;
}

std::string short_flag(const std::string& flag) {
  if (flag == "output") return "o";
  if (flag == "quiet") return "q";
  return "";
}

}  // namespace pilotage
