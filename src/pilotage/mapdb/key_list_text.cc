#include "pilotage/mapdb/key_list_text.h"

#include <algorithm>
#include <charconv>
#include <string_view>
#include <utility>

#include "pilotage/base/error.h"
#include "pilotage/mapdb/minisign_files.h"

namespace pilotage {
namespace {

constexpr std::string_view kFirstLine = "pilotage key list 1";
constexpr std::size_t kMaxRoots = 16;
constexpr std::size_t kMaxSigners = 64;
constexpr std::size_t kMaxNameBytes = 100;
constexpr std::size_t kKeyCharacters = 56;

/// A line, and what messages call it.
struct Line {
  std::string where;
  std::string_view text;
};

/// The lines that say something: not empty, no comment. Each ends with a line feed.
std::vector<Line> lines_of(const std::string& text, const std::string& name) {
  std::vector<Line> lines;
  std::string_view rest = text;
  for (int number = 1; !rest.empty(); ++number) {
    const std::string where = name + ": line " + std::to_string(number);
    const std::size_t end = rest.find('\n');
    if (end == std::string_view::npos) throw DataError(where + ": does not end with a line feed");
    const std::string_view line = rest.substr(0, end);
    rest.remove_prefix(end + 1);
    const auto is_control = [](unsigned char c) { return c < 0x20 || c == 0x7F; };
    if (std::any_of(line.begin(), line.end(), is_control)) throw DataError(where + ": holds a control character");
    if (!line.empty() && !line.starts_with('#')) lines.push_back({where, line});
  }
  return lines;
}

/// What follows `word` and a blank.
std::string value_of(const Line& line, std::string_view word) {
  const std::string begin = std::string(word) + " ";
  if (!line.text.starts_with(begin)) throw DataError(line.where + ": \"" + std::string(word) + " …\" is expected here");
  return std::string(line.text.substr(begin.size()));
}

std::int64_t version_of(const Line& line) {
  const std::string text = value_of(line, "version");
  std::int64_t version = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), version);
  if (error != std::errc{} || end != text.data() + text.size() || version < 1 || version > kMaxKeyListVersion) {
    throw DataError(line.where + ": the version is not a number from 1 to " + std::to_string(kMaxKeyListVersion));
  }
  return version;
}

UtcTime end_of(const Line& line) {
  const std::optional<UtcTime> time = parse_utc_time(value_of(line, "valid-until"));
  if (!time) throw DataError(line.where + ": is not a time like 2026-03-01T06:30:00Z");
  return *time;
}

ListedKey key_of(const Line& line, std::string_view word) {
  const std::string text = value_of(line, word);
  ListedKey listed;
  listed.key = text.substr(0, kKeyCharacters);
  listed.key_id = format_key_id(parse_public_key(listed.key, line.where).key_id);
  if (text.size() < kKeyCharacters + 2 || text.size() > kKeyCharacters + 1 + kMaxNameBytes ||
      text[kKeyCharacters] != ' ') {
    throw DataError(line.where + ": after the key a blank and whose it is are expected, 1 to " +
                    std::to_string(kMaxNameBytes) + " bytes");
  }
  listed.name = text.substr(kKeyCharacters + 1);
  return listed;
}

void add_key(std::vector<ListedKey>& keys, const Line& line, std::string_view word, std::size_t max) {
  keys.push_back(key_of(line, word));
  if (keys.size() > max) {
    throw DataError(line.where + ": more than " + std::to_string(max) + " keys of the kind " + std::string(word));
  }
}

/// One key has one duty, and stands in the list once.
void check_different(const KeyList& list, const std::string& name) {
  std::vector<std::string> ids;
  for (const auto* keys : {&list.roots, &list.signers}) {
    for (const ListedKey& key : *keys) ids.push_back(key.key_id);
  }
  std::sort(ids.begin(), ids.end());
  const auto twice = std::adjacent_find(ids.begin(), ids.end());
  if (twice != ids.end()) throw DataError(name + ": the key " + *twice + " stands in it twice");
}

}  // namespace

KeyList parse_key_list(const std::string& text, const std::string& name) {
  const std::vector<Line> lines = lines_of(text, name);
  if (lines.size() < 5 || lines[0].text != kFirstLine) {
    throw DataError(name + ": is not a key list: \"" + std::string(kFirstLine) +
                    "\", version, valid-until, a root and a signer, each on a line");
  }
  KeyList list;
  list.version = version_of(lines[1]);
  list.valid_until = end_of(lines[2]);
  std::size_t at = 3;
  for (; at < lines.size() && lines[at].text.starts_with("root "); ++at) {
    add_key(list.roots, lines[at], "root", kMaxRoots);
  }
  if (list.roots.empty()) throw DataError(lines[at].where + ": \"root …\" is expected here");
  for (; at < lines.size(); ++at) add_key(list.signers, lines[at], "signer", kMaxSigners);
  if (list.signers.empty()) throw DataError(name + ": names no signer");
  check_different(list, name);
  return list;
}

}  // namespace pilotage
