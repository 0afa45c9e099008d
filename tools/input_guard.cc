#include "input_guard.h"

#include <algorithm>
#include <functional>
#include <system_error>

#include "pilotage/base/error.h"
#include "pilotage/base/output_file.h"
#include "pilotage/ground/ground_imagery.h"
#include "pilotage/mission/frame_table.h"
#include "pilotage/mission/plan_file.h"
#include "pilotage/raster/gdal_io.h"

namespace pilotage {
namespace {

namespace fs = std::filesystem;

bool same_file(const fs::path& a, const fs::path& b) {
  std::error_code ignored;
  if (fs::equivalent(a, b, ignored)) return true;
  return fs::absolute(a, ignored).lexically_normal() == fs::absolute(b, ignored).lexically_normal();
}

using Names = std::vector<std::string>;

Names files_in(const std::string& folder) {
  Names names;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(folder, ignored)) names.push_back(entry.path().string());
  return names;
}

Names frames_of(const std::string& table) {
  Names names;
  for (const FrameRecord& frame :
       frame_table_from_csv(table, read_file(table), {FrameTruth::kCenter, FrameColumns::kFileOnly}).frames) {
    names.push_back(frame_path(table, frame.file));
  }
  return names;
}

Names files_of_plan(const std::string& file) {
  const Mission mission = read_plan(file);
  Names names{mission.flight.route_file};
  Names rasters = dataset_names(mission.ground.imagery);
  if (!mission.ground.elevation.empty()) rasters.push_back(mission.ground.elevation);
  for (const std::string& raster : rasters) {
    const Names files = dataset_files(raster);
    names.insert(names.end(), files.begin(), files.end());
  }
  return names;
}

/// Of the folder that prepare wrote: what its other files are made of. Those may be made again, in their place.
Names files_of_prepare(const std::string& folder) {
  Names names;
  for (const char* name : {"plan.json", "tiles.csv", "selection.json", "map.gpkg"}) {
    names.push_back((fs::path(folder) / name).string());
  }
  const Names behind = files_of_plan(names.front());
  names.insert(names.end(), behind.begin(), behind.end());
  return names;
}

/// What is read besides the input itself. An input that cannot be read leads nowhere: the command says what is wrong
/// with it.
Names files_behind(const NamedFile& input) {
  const std::string name = input.path.string();
  const std::size_t equals = name.find('=');  // of PLACE=FOLDER
  std::error_code ignored;
  const bool of_prepare = fs::exists(fs::path(name) / "plan.json", ignored);
  if (!of_prepare && fs::is_directory(name, ignored)) return files_in(name);
  if (!fs::exists(name, ignored) && equals != std::string::npos) return files_in(name.substr(equals + 1));
  if (name.ends_with(".gpkg")) return {};  // leads nowhere; a map is opened by its own reader alone
  std::function<Names(const std::string&)> list = dataset_files;
  if (of_prepare) list = files_of_prepare;
  if (name.ends_with(".json")) list = files_of_plan;
  if (input.flag.ends_with("frames")) list = frames_of;
  try {
    return list(name);
  } catch (const DataError&) {
    return {};
  } catch (const UsageError&) {
    return {};
  }
}

}  // namespace

std::vector<std::string> paths_of(const OptionField& field) {
  const OptionValue value = field.get();
  if (const auto* text = std::get_if<std::string>(&value)) return {*text};
  if (const auto* texts = std::get_if<std::vector<std::string>>(&value)) return *texts;
  return {};
}

void refuse_shared_files(const std::vector<NamedFile>& inputs, const std::vector<NamedFile>& outputs) {
  std::error_code ignored;
  const bool replaces = std::any_of(outputs.begin(), outputs.end(),
                                    [&](const NamedFile& output) { return fs::exists(output.path, ignored); });
  for (const NamedFile& input : inputs) {
    // What does not exist is no input, so what lies behind one matters only when an output exists.
    Names names = replaces ? files_behind(input) : Names{};
    names.insert(names.begin(), input.path.string());
    for (const NamedFile& output : outputs) {
      const auto shared =
          std::find_if(names.begin(), names.end(), [&](const auto& name) { return same_file(output.path, name); });
      if (shared == names.end()) continue;
      throw UsageError(output.flag + " = \"" + output.path.string() + "\" is also an input (" + input.flag +
                       (shared == names.begin() ? "" : " \"" + names.front() + "\" leads to it") +
                       "), which would be lost; write somewhere else");
    }
  }
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if (same_file(outputs[i].path, outputs[j].path)) {
        throw UsageError(outputs[i].flag + " = \"" + outputs[i].path.string() + "\" is also what " + outputs[j].flag +
                         " writes; give each output a name of its own");
      }
    }
  }
}

}  // namespace pilotage
