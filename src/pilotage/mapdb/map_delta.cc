#include "pilotage/mapdb/map_delta.h"

#include <algorithm>
#include <fstream>
#include <memory>
#include <string_view>
#include <utility>
#include <vector>

#include <sodium.h>
#include <zstd.h>

#include "pilotage/base/error.h"
#include "pilotage/base/file_digest.h"
#include "pilotage/base/output_file.h"
#include "pilotage/base/read_file.h"
#include "pilotage/base/staging_folder.h"
#include "pilotage/mapdb/byte_order.h"
#include "pilotage/mapdb/chunked_file.h"
#include "pilotage/mapdb/map_delta_format.h"
#include "pilotage/mapdb/map_reader.h"
#include "pilotage/mapdb/minisign_files.h"
#include "pilotage/mapdb/trusted_signature.h"

namespace pilotage {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t kMostDeltaBytes = std::uintmax_t{8} << 30;

std::string hex_of(const std::array<std::uint8_t, 32>& digest) {
  std::string hex(2 * digest.size() + 1, '\0');
  sodium_bin2hex(hex.data(), hex.size(), digest.data(), digest.size());
  hex.pop_back();
  return hex;
}

/// Takes a delta apart; every number is held against what is left of it.
class DeltaBytes {
 public:
  DeltaBytes(std::string_view bytes, std::string name) : rest_(bytes), name_(std::move(name)) {}

  bool empty() const { return rest_.empty(); }
  /// Whether this comes next; it is taken.
  bool begins_with(std::string_view text) {
    if (!rest_.starts_with(text)) return false;
    rest_.remove_prefix(text.size());
    return true;
  }
  template <class T>
  T integer() {
    return read_le<T>(reinterpret_cast<const std::uint8_t*>(text(sizeof(T)).data()));
  }
  std::array<std::uint8_t, 32> digest() {
    std::array<std::uint8_t, 32> value{};
    const std::string_view bytes = text(value.size());
    std::copy(bytes.begin(), bytes.end(), value.begin());
    return value;
  }
  std::string_view text(std::uint64_t bytes) {
    if (bytes > rest_.size()) fail("ends too soon");
    const std::string_view part = rest_.substr(0, bytes);
    rest_.remove_prefix(bytes);
    return part;
  }
  [[noreturn]] void fail(const std::string& what) const { throw DataError(name_ + ": is no whole delta: it " + what); }

 private:
  std::string_view rest_;
  std::string name_;
};

MapDeltaHeader read_header(DeltaBytes& bytes, const std::string& name) {
  if (!bytes.begins_with(kMapDeltaMagic)) {
    throw DataError(name + ": is not the delta of a map, or of a newer version than this program reads");
  }
  MapDeltaHeader header;
  header.old_bytes = bytes.integer<std::uint64_t>();
  header.old_digest = bytes.digest();
  header.new_bytes = bytes.integer<std::uint64_t>();
  header.new_digest = bytes.digest();
  const auto signature_bytes = bytes.integer<std::uint32_t>();
  if (signature_bytes > kMaxDeltaSignatureBytes) bytes.fail("holds a signature that is too long");
  header.signature = bytes.text(signature_bytes);
  header.chunk_list = bytes.text(bytes.integer<std::uint64_t>());
  return header;
}

MapDeltaFrame read_frame(DeltaBytes& bytes, const MapDeltaHeader& header, std::uint64_t done) {
  MapDeltaFrame frame;
  frame.old_offset = bytes.integer<std::uint64_t>();
  frame.old_bytes = bytes.integer<std::uint32_t>();
  frame.new_bytes = bytes.integer<std::uint32_t>();
  frame.compressed_bytes = bytes.integer<std::uint32_t>();
  if (frame.old_bytes > kDeltaWindowBytes || frame.old_offset > header.old_bytes ||
      frame.old_bytes > header.old_bytes - frame.old_offset) {
    bytes.fail("refers to bytes that the old map does not have");
  }
  if (frame.new_bytes == 0 || frame.new_bytes > kDeltaFrameBytes || frame.new_bytes > header.new_bytes - done) {
    bytes.fail("makes more than it says");
  }
  return frame;
}

struct FreeDecompression {
  void operator()(ZSTD_DCtx* context) const { ZSTD_freeDCtx(context); }
};

/// Writes the new map to `path`.
void apply_frames(DeltaBytes& bytes, const MapDeltaHeader& header, const fs::path& old_map, const fs::path& path,
                  const Progress& progress) {
  std::ifstream old_file(old_map, std::ios::binary);
  std::ofstream new_file(path, std::ios::binary);
  const std::unique_ptr<ZSTD_DCtx, FreeDecompression> context(ZSTD_createDCtx());
  if (context == nullptr || ZSTD_isError(ZSTD_DCtx_setParameter(context.get(), ZSTD_d_windowLogMax, kDeltaWindowLog))) {
    throw DataError("zstd cannot be started");
  }
  std::string window;
  std::string part;
  std::uint64_t done = 0;
  while (done < header.new_bytes) {
    report_progress(progress, "making the new map", static_cast<std::int64_t>(done),
                    static_cast<std::int64_t>(header.new_bytes));
    const MapDeltaFrame frame = read_frame(bytes, header, done);
    const std::string_view compressed = bytes.text(frame.compressed_bytes);
    window.resize(frame.old_bytes);
    old_file.seekg(static_cast<std::streamoff>(frame.old_offset));
    if (!old_file.read(window.data(), static_cast<std::streamsize>(window.size()))) {
      throw DataError(old_map.string() + ": cannot be read");
    }
    part.resize(frame.new_bytes);
    ZSTD_DCtx_refPrefix(context.get(), window.data(), window.size());
    const std::size_t made =
        ZSTD_decompressDCtx(context.get(), part.data(), part.size(), compressed.data(), compressed.size());
    if (ZSTD_isError(made) || made != part.size()) bytes.fail("does not unpack");
    new_file.write(part.data(), static_cast<std::streamsize>(part.size()));
    done += part.size();
  }
  if (!bytes.empty()) bytes.fail("goes on after its end");
  new_file.close();
  if (!new_file) throw DataError(path.string() + ": cannot be written");
}

void require_old_map(const fs::path& old_map, const MapDeltaHeader& header, const std::string& delta) {
  std::error_code error;
  const std::uintmax_t bytes = fs::file_size(old_map, error);
  if (error) throw DataError(old_map.string() + ": cannot be read: " + error.message());
  if (bytes == header.old_bytes && file_digest(old_map) == hex_of(header.old_digest)) return;
  throw DataError(old_map.string() + ": is not the map that " + delta + " begins with (" +
                  std::to_string(header.old_bytes) + " bytes, BLAKE2b-256 " + hex_of(header.old_digest) + ")");
}

void refuse_in_place(const fs::path& old_map, const fs::path& new_map) {
  std::error_code ignored;
  if (old_map != new_map && !fs::equivalent(old_map, new_map, ignored)) return;
  throw UsageError(new_map.string() +
                   ": is the old map; give the new one another name, so that one of them is whole "
                   "whatever happens");
}

/// A delta can unpack to much more than itself.
void require_room(const fs::path& new_map, const MapDeltaHeader& header, const std::string& delta) {
  std::error_code error;
  const fs::path folder = new_map.has_parent_path() ? new_map.parent_path() : fs::path(".");
  const fs::space_info space = fs::space(folder, error);
  if (error || space.available >= header.new_bytes) return;
  throw DataError(delta + ": makes a map of " + std::to_string(header.new_bytes) + " bytes, and " + folder.string() +
                  " has room for " + std::to_string(space.available));
}

/// The list is not among the bytes that the digest is of: it must be the map's.
void check_chunk_list(const fs::path& map, const MapDeltaHeader& header, const std::string& delta) {
  std::vector<std::uint8_t> expected;
  append_text(expected, kChunkListMagic);
  append_le(expected, header.new_bytes);
  std::ifstream file(map, std::ios::binary);
  std::string chunk(kChunkBytes, '\0');
  while (file.read(chunk.data(), static_cast<std::streamsize>(chunk.size())), file.gcount() > 0) {
    const auto digest = blake2b_256(std::string_view(chunk).substr(0, static_cast<std::size_t>(file.gcount())));
    expected.insert(expected.end(), digest.begin(), digest.end());
  }
  if (!std::equal(expected.begin(), expected.end(), header.chunk_list.begin(), header.chunk_list.end(),
                  [](std::uint8_t a, char b) { return a == static_cast<std::uint8_t>(b); })) {
    throw IntegrityError(delta + ": its list of chunks is not that of the map that it makes");
  }
}

/// Messages name the place where the map will stand, not the one where it grew.
std::string with_place_named(std::string message, const fs::path& grown, const fs::path& place) {
  const std::size_t at = message.find(grown.string());
  if (at != std::string::npos) message.replace(at, grown.string().size(), place.string());
  return message;
}

/// Its signature, where keys are given, and what it is for; never an older map than the one before.
void check_new_map(const fs::path& old_map, const fs::path& map, const MapUpdateOptions& options,
                   const std::string& delta, MapUpdate& update) {
  MapRequirements required = options.required;
  const MapPurpose before = MapReader::open_unverified(old_map).purpose();
  if (before.map_version) {
    required.min_version = std::max(required.min_version.value_or(1), *before.map_version + 1);
  }
  if (!required.mission_name) required.mission_name = before.mission_name;
  std::optional<SignedMap> signed_map;
  if (!options.trusted_keys.empty()) {
    if (!fs::exists(signature_path_of(map))) {
      throw IntegrityError(delta + ": the map that it makes is not signed, and a signature is asked for");
    }
    signed_map = read_signed_map(map, options.trusted_keys);
    update.signature = signed_map->signature();
  }
  const MapReader reader = signed_map ? MapReader::open(*signed_map) : MapReader::open_unverified(map);
  check_purpose(reader, required);
  update.purpose = reader.purpose();
}

}  // namespace

MapDeltaHeader unpack_map_delta(std::string_view delta, const std::string& name, const fs::path& old_map,
                                const fs::path& new_map, const Progress& progress) {
  DeltaBytes bytes(delta, name);
  MapDeltaHeader header = read_header(bytes, name);
  require_old_map(old_map, header, name);
  require_room(new_map, header, name);
  apply_frames(bytes, header, old_map, new_map, progress);
  if (file_digest(new_map) != hex_of(header.new_digest)) {
    throw IntegrityError(name + ": what it makes is not the map that it says (BLAKE2b-256 " +
                         hex_of(header.new_digest) + ")");
  }
  return header;
}

fs::path map_delta_path_of(const fs::path& map) {
  return map.string() + ".delta";
}

MapUpdate update_map(const fs::path& old_map, const fs::path& delta, const fs::path& new_map,
                     const MapUpdateOptions& options, const Progress& progress) {
  refuse_in_place(old_map, new_map);
  const std::string name = delta.string();
  const bool checked = !options.trusted_keys.empty();
  const std::string content = read_file(delta, kMostDeltaBytes);
  if (checked)
    check_signed_bytes(name, content, read_trusted_signature(signature_path_of(delta), options.trusted_keys));
  for (const fs::path& output : {new_map, signature_path_of(new_map), chunk_list_path_of(new_map)}) {
    const OutputFile refused(output, options.overwrite);  // before the work
  }
  const fs::path folder = new_map.has_parent_path() ? new_map.parent_path() : fs::path(".");
  const StagingFolder staging(folder);
  const std::string map_name = new_map.filename().string();
  const fs::path map = staging / map_name;
  const MapDeltaHeader header = unpack_map_delta(content, name, old_map, map, progress);
  MapUpdate update{header.new_bytes, hex_of(header.new_digest), {}, {}};
  std::vector<std::string> written;
  if (!header.chunk_list.empty()) check_chunk_list(map, header, name);
  for (const auto& [beside, text] : {std::pair(chunk_list_path_of(map_name), header.chunk_list),
                                     std::pair(signature_path_of(map_name), header.signature)}) {
    if (text.empty()) continue;
    write_file(staging / beside.string(), text, false);
    written.push_back(beside.string());
  }
  try {
    check_new_map(old_map, map, options, name, update);
  } catch (const IntegrityError& error) {
    throw IntegrityError(with_place_named(error.what(), map, new_map));
  } catch (const DataError& error) {
    throw DataError(with_place_named(error.what(), map, new_map));
  }
  written.push_back(map_name);  // last: where it stands, its signature does
  staging.publish(written, {chunk_list_path_of(map_name).string(), signature_path_of(map_name).string()});
  return update;
}

}  // namespace pilotage
