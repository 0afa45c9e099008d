#pragma once

#include <string>

#pragma GCC visibility push(default)

namespace pilotage {

/// Under which terms data may be used, and who is to be named with what is made of them. Both empty where nobody says.
struct Licence {
  std::string terms;        ///< SPDX identifier ("CC-BY-4.0", spdx.org/licenses), or words.
  std::string attribution;  ///< "© OpenAerialMap contributors".

  bool operator==(const Licence&) const = default;
};

/// What is known of it: where `said` leaves a part empty, that of `otherwise`.
inline Licence licence_or(const Licence& said, const Licence& otherwise) {
  return {said.terms.empty() ? otherwise.terms : said.terms,
          said.attribution.empty() ? otherwise.attribution : said.attribution};
}

/// Both for people; "" where neither is known.
inline std::string licence_text(const Licence& licence) {
  return licence.terms + (licence.terms.empty() || licence.attribution.empty() ? "" : "; ") + licence.attribution;
}

/// The tags of a raster's metadata that say it.
inline constexpr const char* kLicenceTag = "PILOTAGE_LICENCE";
inline constexpr const char* kAttributionTag = "PILOTAGE_ATTRIBUTION";

/// What a raster's metadata say: kLicenceTag and kAttributionTag; where the second is missing TIFFTAG_COPYRIGHT, or the
/// copyright of EXIF. `dataset` is what GDAL opens. Throws DataError, naming the dataset, when it cannot be opened.
Licence read_licence(const std::string& dataset);

}  // namespace pilotage

#pragma GCC visibility pop
