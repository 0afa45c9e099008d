#include "pilotage/raster/gdal_cog.h"

#include <string_view>

#include <gdal_priv.h>

#include "pilotage/base/error.h"
#include "pilotage/raster/gdal_handle.h"
#include "pilotage/raster/gdal_local_config.h"

namespace pilotage {
namespace {

/// GDAL's progress function: `data` is a Progress. 0 ends the writing.
int CPL_STDCALL go_on_writing(double done, const char* /*message*/, void* data) {
  const auto& progress = *static_cast<const Progress*>(data);
  return !progress || progress("writing the raster", static_cast<std::int64_t>(100 * done), 100) ? 1 : 0;
}

}  // namespace

void make_cog(GDALDataset& source, const std::filesystem::path& path, const std::string& name,
              const std::vector<std::string>& options, const Progress& progress) {
  const GdalErrors errors;
  const LocalConfig no_side_car("GDAL_PAM_ENABLED", "NO");
  GDALDriver* driver = GetGDALDriverManager()->GetDriverByName("COG");
  if (driver == nullptr) throw DataError(name + ": this GDAL has no COG driver");
  std::vector<const char*> list;
  for (const std::string& option : options) list.push_back(option.c_str());
  list.push_back(nullptr);
  bool interrupted = false;
  Progress heard = [&](std::string_view what, std::int64_t done, std::int64_t total) {
    interrupted = interrupted || (progress && !progress(what, done, total));
    return !interrupted;
  };
  DatasetPtr written(
      driver->CreateCopy(path.c_str(), &source, TRUE, const_cast<char**>(list.data()), go_on_writing, &heard));
  const bool created = written != nullptr;
  written.reset();
  if (interrupted) throw Interrupted{};
  if (!created || errors.failed()) errors.throw_data_error(name + ": cannot be written");
}

}  // namespace pilotage
