#include "pilotage/mapdb/map_info.h"

#include <utility>

#include "pilotage/base/error.h"
#include "pilotage/base/file_digest.h"
#include "pilotage/base/text.h"
#include "pilotage/camera/camera_text.h"
#include "pilotage/vision/ground_pattern.h"

namespace pilotage {
namespace {

/// The entries whose keys begin with `prefix`, without it.
std::vector<std::pair<std::string, std::string>> entries_below(const MapInfo& info, std::string_view prefix) {
  std::vector<std::pair<std::string, std::string>> found;
  for (const MapInfoEntry& entry : info.entries) {
    if (entry.key.starts_with(prefix)) found.emplace_back(entry.key.substr(prefix.size()), entry.value);
  }
  return found;
}

}  // namespace

std::optional<std::string> MapInfo::find(std::string_view key) const {
  for (const MapInfoEntry& entry : entries) {
    if (entry.key == key) return entry.value;
  }
  return std::nullopt;
}

std::optional<Camera> camera_of_info(const MapInfo& info, const std::string& file) {
  const CameraText text = entries_below(info, "camera.");
  if (text.empty()) return std::nullopt;
  return camera_from_text(file + ": map_info: camera", text);
}

FeatureOptions features_of_info(const MapInfo& info, const std::string& file) {
  FeatureOptions options;
  const auto entries = entries_below(info, "features.");
  if (entries.empty()) return options;
  const std::string where = file + ": map_info: features";
  const OptionList list = list_options(options);
  std::vector<std::string> missing;
  for (const OptionField& field : list.fields) missing.push_back(field.path);
  try {
    for (const auto& [key, value] : entries) {
      const OptionField* const field = list.find(key);
      if (field == nullptr) throw DataError(where + ": unknown key \"" + key + "\"");
      if (std::erase(missing, key) == 0) throw DataError(where + ": duplicate key \"" + key + "\"");
      set_from_text(*field, {value});
    }
    check_feature_options(options);
  } catch (const UsageError& error) {
    throw DataError(where + ": " + error.what());
  }
  if (!missing.empty()) throw DataError(where + ": \"" + missing.front() + "\" is missing");
  const std::optional<std::string> tests = info.find("pattern_digest");
  if (tests && *tests != pattern_digest(options.pattern)) {
    throw DataError(file + ": map_info: its descriptors are of other tests than the pattern " +
                    options_detail::enum_to_name(options.pattern) + " of this program has; build it anew");
  }
  return options;
}

std::optional<double> elevation_sigma_m_of_info(const MapInfo& info, const std::string& file) {
  const std::optional<std::string> text = info.find("elevation_sigma_m");
  if (!text) return std::nullopt;
  const std::optional<double> sigma_m = parse_number(*text);
  if (sigma_m && *sigma_m >= 0 && *sigma_m <= 100) return sigma_m;
  throw DataError(file + ": map_info: elevation_sigma_m = \"" + text->substr(0, 40) + "\" is no number in [0, 100]");
}

std::string pattern_digest(DescriptorPattern pattern) {
  if (pattern != DescriptorPattern::kGround) return "";
  std::string bytes;
  for (const BriefPair& test : kGroundPattern) {
    for (const std::int8_t offset : {test.x1, test.y1, test.x2, test.y2}) bytes.push_back(static_cast<char>(offset));
  }
  return bytes_digest(bytes);
}

}  // namespace pilotage
