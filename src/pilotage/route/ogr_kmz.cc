#include "pilotage/route/ogr_kmz.h"

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <memory>

#include <cpl_conv.h>
#include <cpl_string.h>
#include <cpl_vsi.h>

#include "pilotage/base/error.h"
#include "pilotage/raster/gdal_handle.h"
#include "pilotage/route/ogr_memory_file.h"
#include "pilotage/route/read_route.h"

namespace pilotage {
namespace {

bool is_document(std::string path) {
  std::transform(path.begin(), path.end(), path.begin(), [](unsigned char c) { return std::tolower(c); });
  return path.ends_with(".kml") || path.ends_with(".wpml");
}

/// Of an archive: a mission has some dozen. GDAL lists them in time that grows with the square of their number.
constexpr std::size_t kMostEntries = 1000;

/// What the end of the archive says (APPNOTE.TXT 4.3.16), which is what GDAL goes by. Throws DataError when there are
/// too many, or the archive is of the form for more than 65,535.
void check_entry_count(const std::string& name, std::string_view bytes) {
  constexpr std::size_t kEndBytes = 22;
  constexpr std::size_t kLongestComment = 65535;
  const std::string_view tail = bytes.substr(bytes.size() - std::min(bytes.size(), kEndBytes + kLongestComment));
  const std::size_t end = tail.rfind("PK\x05\x06");
  if (end == std::string_view::npos || end + kEndBytes > tail.size()) return;  // GDAL says that it is no archive
  const auto byte = [&](std::size_t at) {
    return static_cast<std::size_t>(static_cast<unsigned char>(tail[end + at]));
  };
  const std::size_t entries = byte(10) | byte(11) << 8;
  const bool is_long = tail.substr(0, end).find("PK\x06\x07") != std::string_view::npos;
  if (entries <= kMostEntries && !is_long) return;
  throw DataError(name + ": cannot be read as KMZ: the archive holds " +
                  (is_long ? "a directory for more than 65535" : std::to_string(entries)) + " entries, at most " +
                  std::to_string(kMostEntries) + " are allowed");
}

}  // namespace

std::vector<KmzDocument> unpack_kmz(const std::string& name, std::string_view bytes) {
  check_entry_count(name, bytes);
  const GdalErrors errors;
  const OgrMemoryFile archive(bytes, "kmz");
  const std::string folder = "/vsizip/" + archive.path();
  const std::unique_ptr<char*, decltype(&CSLDestroy)> entries(VSIReadDirRecursive(folder.c_str()), CSLDestroy);
  std::vector<std::string> paths;
  std::uint64_t total = 0;
  for (char** entry = entries.get(); entry != nullptr && *entry != nullptr; ++entry) {
    VSIStatBufL status{};
    if (VSIStatL((folder + "/" + *entry).c_str(), &status) == 0) total += static_cast<std::uint64_t>(status.st_size);
    if (is_document(*entry)) paths.emplace_back(*entry);
  }
  if (paths.empty()) throw DataError(name + ": cannot be read as KMZ: the archive holds no .kml file");
  if (total > kMaxRouteBytes) {
    throw DataError(name + ": unpacks to " + std::to_string(total) + " bytes, at most " +
                    std::to_string(kMaxRouteBytes) + " are allowed");
  }
  std::vector<KmzDocument> documents;
  for (const std::string& path : paths) {
    GByte* unpacked = nullptr;
    vsi_l_offset size = 0;
    const int done =
        VSIIngestFile(nullptr, (folder + "/" + path).c_str(), &unpacked, &size, static_cast<GIntBig>(kMaxRouteBytes));
    const std::unique_ptr<GByte, decltype(&VSIFree)> freed(unpacked, VSIFree);
    if (done == 0) throw DataError(name + ": cannot be read as KMZ: " + path + " in it is damaged");
    documents.push_back({path, std::string(reinterpret_cast<const char*>(unpacked), static_cast<std::size_t>(size))});
  }
  return documents;
}

const KmzDocument& main_document(const std::string& name, const std::vector<KmzDocument>& documents) {
  const KmzDocument* first = nullptr;
  for (const KmzDocument& document : documents) {
    if (document.path == "doc.kml") return document;
    const bool is_kml = document.path.ends_with(".kml") || document.path.ends_with(".KML");
    if (first == nullptr && is_kml) first = &document;
  }
  if (first == nullptr) throw DataError(name + ": cannot be read as KMZ: the archive holds no .kml file");
  return *first;
}

}  // namespace pilotage
