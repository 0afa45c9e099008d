#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace pilotage {

/// A document in a KMZ archive.
struct KmzDocument {
  std::string path;  ///< Inside the archive.
  std::string text;
};

/// The .kml and .wpml documents of a KMZ archive in the archive's order. `name` stands in messages. Throws DataError
/// when there is none, or when the archive unpacks to more than kMaxRouteBytes: a small one may unpack to any size, so
/// that is looked at first.
std::vector<KmzDocument> unpack_kmz(const std::string& name, std::string_view bytes);

/// The document of a KMZ of any maker: doc.kml, else the first .kml. Throws DataError when there is none.
const KmzDocument& main_document(const std::string& name, const std::vector<KmzDocument>& documents);

}  // namespace pilotage
