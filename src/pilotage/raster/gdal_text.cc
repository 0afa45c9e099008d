#include "pilotage/raster/gdal_text.h"

#include <filesystem>
#include <memory>
#include <string_view>

#include <cpl_http.h>
#include <cpl_vsi.h>

#include "pilotage/base/error.h"
#include "pilotage/base/read_file.h"
#include "pilotage/raster/gdal_handle.h"

namespace pilotage {
namespace {

constexpr std::string_view kCurl = "/vsicurl/";

/// An answer that a server makes as it is asked has no size beforehand, which /vsicurl/ would want to know.
std::string fetch_text(const std::string& name, std::size_t max_bytes) {
  const GdalErrors errors;
  const std::string address = name.substr(kCurl.size());
  const char* const options[] = {"TIMEOUT=120", "CONNECTTIMEOUT=20", "MAX_RETRY=3", "RETRY_DELAY=2", nullptr};
  const std::unique_ptr<CPLHTTPResult, void (*)(CPLHTTPResult*)> answer(
      CPLHTTPFetch(address.c_str(), const_cast<char**>(options)), CPLHTTPDestroyResult);
  if (answer == nullptr || answer->nStatus != 0 || answer->pszErrBuf != nullptr) {
    const std::string why = answer != nullptr && answer->pszErrBuf != nullptr ? answer->pszErrBuf : errors.message();
    throw DataError(name + ": cannot be fetched: " + why);
  }
  if (static_cast<std::size_t>(answer->nDataLen) > max_bytes) {
    throw DataError(name + ": has more than " + std::to_string(max_bytes) + " bytes");
  }
  return {reinterpret_cast<const char*>(answer->pabyData), static_cast<std::size_t>(answer->nDataLen)};
}

}  // namespace

std::string read_gdal_text(const std::string& name, std::size_t max_bytes) {
  if (name.starts_with("/vsicurl/http")) return fetch_text(name, max_bytes);
  if (!name.starts_with("/vsi")) return read_file(name, max_bytes);
  const GdalErrors errors;
  const std::unique_ptr<VSILFILE, int (*)(VSILFILE*)> file(VSIFOpenL(name.c_str(), "rb"), VSIFCloseL);
  if (file == nullptr) {
    if (errors.message().empty()) throw DataError(name + ": cannot be read");
    errors.throw_data_error(name);
  }
  std::string text;
  std::string part(std::size_t{1} << 16, '\0');
  while (const std::size_t got = VSIFReadL(part.data(), 1, part.size(), file.get())) {
    text.append(part, 0, got);
    if (text.size() > max_bytes) throw DataError(name + ": has more than " + std::to_string(max_bytes) + " bytes");
  }
  if (errors.failed()) errors.throw_data_error(name);
  return text;
}

}  // namespace pilotage
