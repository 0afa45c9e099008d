#include "pilotage/raster/gdal_licence.h"

#include <array>
#include <utility>

#include "pilotage/base/utf8.h"
#include "pilotage/raster/gdal_handle.h"

namespace pilotage {

Licence find_licence(GDALDataset& dataset) {
  const auto tag = [&](const char* name, const char* domain) {
    const char* text = dataset.GetMetadataItem(name, domain);
    return text == nullptr ? std::string() : valid_utf8(text);
  };
  Licence licence{tag(kLicenceTag, ""), tag(kAttributionTag, "")};
  static constexpr std::array<std::pair<const char*, const char*>, 3> kCopyrights{
      {{"TIFFTAG_COPYRIGHT", ""}, {"EXIF_Copyright", ""}, {"EXIF_Copyright", "EXIF"}}};
  for (const auto& [name, domain] : kCopyrights) {
    if (licence.attribution.empty()) licence.attribution = tag(name, domain);
  }
  return licence;
}

Licence read_licence(const std::string& dataset) {
  return find_licence(*open_raster(dataset));
}

}  // namespace pilotage
