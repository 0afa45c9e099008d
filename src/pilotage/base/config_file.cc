#include "pilotage/base/config_file.h"

#include <algorithm>
#include <system_error>

#include <nlohmann/json.hpp>

#include "pilotage/base/options_json.h"
#include "pilotage/base/output_file.h"
#include "pilotage/base/utf8.h"

namespace pilotage {
namespace {

using Json = nlohmann::ordered_json;

/// The value at a dotted path, or nullptr.
Json* find_value(Json& root, const std::string& path) {
  Json* at = &root;
  for (std::size_t begin = 0; begin <= path.size();) {
    const std::size_t end = std::min(path.find('.', begin), path.size());
    const std::string key = path.substr(begin, end - begin);
    if (!at->is_object() || !at->contains(key)) return nullptr;
    at = &(*at)[key];
    begin = end + 1;
  }
  return at;
}

void resolve(Json& value, const std::filesystem::path& folder) {
  const auto beside = [&](const Json& text) {
    return name_as_utf8(path_beside(bytes_of_name(text.get<std::string>()), folder));
  };
  if (value.is_string()) value = beside(value);
  if (!value.is_array()) return;
  for (Json& element : value) {
    if (element.is_string()) element = beside(element);
  }
}

}  // namespace

std::string path_beside(const std::string& path, const std::filesystem::path& folder) {
  if (path.empty() || path.front() == '/') return path;
  const std::filesystem::path beside = folder / path;
  std::error_code ignored;
  return std::filesystem::exists(beside, ignored) ? beside.lexically_normal().string() : path;
}

void load_config_file(const OptionList& list, const std::filesystem::path& file) {
  load_config(list, file.string(), read_file(file, kMaxConfigBytes), file.parent_path());
}

void load_config(const OptionList& list, const std::string& name, std::string_view text,
                 const std::filesystem::path& folder) {
  Json json = parse_json(name, text);
  for (const OptionField& field : list.fields) {
    if (!field.is_path) continue;
    if (Json* value = find_value(json, field.path)) resolve(*value, folder);
  }
  set_options_from_json(list, json, name);
}

}  // namespace pilotage
