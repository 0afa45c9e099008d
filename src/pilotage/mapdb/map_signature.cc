#include "pilotage/mapdb/map_signature.h"

#include <limits>
#include <string_view>
#include <system_error>

#include "pilotage/base/error.h"
#include "pilotage/base/read_file.h"
#include "pilotage/mapdb/chunked_file.h"
#include "pilotage/mapdb/map_types.h"
#include "pilotage/mapdb/sqlite.h"
#include "pilotage/mapdb/trusted_signature.h"

namespace pilotage {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kChunksMark = "chunks:";

/// The field of a trusted comment that names a list of chunks, or "". Fields stand between tabs.
std::string chunks_mark_of(const std::string& trusted_comment) {
  std::string_view rest = trusted_comment;
  while (true) {
    const std::size_t tab = rest.find('\t');
    const std::string_view field = rest.substr(0, tab);
    if (field.starts_with(kChunksMark)) return std::string(field);
    if (tab == std::string_view::npos) return {};
    rest.remove_prefix(tab + 1);
  }
}

std::string read_chunk_list(const fs::path& path, const fs::path& list_path, const std::string& mark) {
  std::error_code error;
  if (!fs::exists(list_path, error)) {
    throw DataError(list_path.string() + ": does not exist, and the signature names it: copy it beside " +
                    path.filename().string() + ", where `pilotage build` wrote it");
  }
  std::string list = read_file(list_path);
  if (chunk_list_mark(list) != mark) {
    throw IntegrityError(list_path.string() +
                         ": is not the list of chunks that was signed: copy map, signature and "
                         "list again, together");
  }
  return list;
}

}  // namespace

fs::path signature_path_of(const fs::path& path) {
  fs::path result = path;
  result += ".minisig";
  return result;
}

fs::path chunk_list_path_of(const fs::path& path) {
  fs::path result = path;
  result += ".chunks";
  return result;
}

std::uint64_t SignedMap::size() const {
  return bytes_ ? bytes_->size() : chunks_->size();
}

Database SignedMap::open_database() const {
  return bytes_ ? Database::open_untrusted(name_, bytes_, kMaxMapBlobBytes)
                : Database::open_untrusted(name_, chunks_, kMaxMapBlobBytes);
}

SignedMap read_signed_map(const fs::path& path, const std::vector<std::string>& trusted_keys,
                          const std::optional<fs::path>& signature_path) {
  const TrustedSignature trusted =
      read_trusted_signature(signature_path.value_or(signature_path_of(path)), trusted_keys);
  const MinisignSignature& signature = trusted.signature;
  SignedMap map(path.string(), {signature.trusted_comment, format_key_id(signature.key_id), signature.prehashed});
  const std::string mark = chunks_mark_of(signature.trusted_comment);
  if (!mark.empty()) {
    const fs::path list_path = chunk_list_path_of(path);
    map.chunks_ = std::make_shared<const ChunkedFile>(path, list_path.string(), read_chunk_list(path, list_path, mark));
    return map;
  }
  map.bytes_ = std::make_shared<const std::string>(read_file(path, std::numeric_limits<std::uintmax_t>::max()));
  check_signed_bytes(map.name_, *map.bytes_, trusted);
  return map;
}

}  // namespace pilotage
