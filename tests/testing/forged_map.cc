#include "testing/forged_map.h"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "pilotage/base/output_file.h"
#include "pilotage/mapdb/map_types.h"
#include "pilotage/mapdb/sqlite.h"

namespace pilotage::testing {
namespace {

constexpr std::size_t kFileHeaderBytes = 100;
constexpr std::size_t kInteriorHeaderBytes = 12;
constexpr char kInteriorTablePage = 5;

std::uint32_t byte_of(const std::string& bytes, std::size_t at) {
  return static_cast<unsigned char>(bytes.at(at));
}

std::uint32_t get_16(const std::string& bytes, std::size_t at) {
  return (byte_of(bytes, at) << 8) | byte_of(bytes, at + 1);
}

// What costs, in places where text of the schema stands.
constexpr std::array<std::string_view, 8> kWords = {" AS (",
                                                    " CHECK (",
                                                    " GENERATED ALWAYS AS (",
                                                    " WITHOUT ROWID",
                                                    " COLLATE x",
                                                    " UNIQUE ",
                                                    "instr(hex(zeroblob(30000000)),hex(zeroblob(10000000))||'1')",
                                                    "CREATE VIEW "};

}  // namespace

ForgedFile::ForgedFile(std::string bytes) : bytes_(std::move(bytes)) {
  if (bytes_.size() < kFileHeaderBytes || !bytes_.starts_with("SQLite format 3")) {
    throw std::invalid_argument("not an SQLite file");
  }
  page_size_ = get_16(bytes_, 16) == 1 ? 65536 : get_16(bytes_, 16);
  if (page_size_ < 512 || bytes_.size() % page_size_ != 0) throw std::invalid_argument("not whole pages");
}

std::uint32_t ForgedFile::page_count() const {
  return static_cast<std::uint32_t>(bytes_.size() / page_size_);
}

void ForgedFile::put_16(std::size_t at, std::uint32_t value) {
  bytes_.at(at) = static_cast<char>(value >> 8);
  bytes_.at(at + 1) = static_cast<char>(value);
}

void ForgedFile::put_32(std::size_t at, std::uint32_t value) {
  put_16(at, value >> 16);
  put_16(at + 2, value);
}

std::uint32_t ForgedFile::append(const std::string& page) {
  bytes_ += page;
  put_32(28, page_count());
  return page_count();
}

std::string ForgedFile::interior_page(std::uint32_t child, std::size_t header) const {
  ForgedFile made = *this;  // for its put_…
  made.bytes_.assign(page_size_, '\0');
  constexpr std::size_t kCellBytes = 5;  // the child's number, and one byte of key
  const std::size_t cells = (page_size_ - header - kInteriorHeaderBytes) / (kCellBytes + 2) - 1;
  const std::size_t content = page_size_ - cells * kCellBytes;
  for (std::size_t i = 0; i < cells; ++i) {
    made.put_32(content + i * kCellBytes, child);
    made.bytes_[content + i * kCellBytes + 4] = 1;
    made.put_16(header + kInteriorHeaderBytes + 2 * i, static_cast<std::uint32_t>(content + i * kCellBytes));
  }
  made.bytes_[header] = kInteriorTablePage;
  made.put_16(header + 3, static_cast<std::uint32_t>(cells));
  made.put_16(header + 5, static_cast<std::uint32_t>(content));
  made.put_32(header + 8, child);
  return made.bytes_;
}

void ForgedFile::read_in_circles(std::uint32_t root, int depth) {
  const std::size_t header = root == 1 ? kFileHeaderBytes : 0;
  std::string leaf = bytes_.substr(at(root), page_size_);
  if (root ==
      1) {  // its own header moves to the begin, with the array behind it, which says where cells lie in the page
    const std::size_t array = 2 * get_16(leaf, header + 3);
    leaf.replace(0, kInteriorHeaderBytes + array, leaf.substr(header, kInteriorHeaderBytes + array));
  }
  std::uint32_t child = append(leaf);
  for (int level = 1; level < depth; ++level) child = append(interior_page(child, 0));
  bytes_.replace(at(root) + header, page_size_ - header, interior_page(child, header).substr(header));
}

void ForgedFile::lengthen_index(std::uint32_t root, int pages) {
  constexpr char kInteriorIndexPage = 2;
  std::uint32_t child = append(bytes_.substr(at(root), page_size_));
  ForgedFile link = *this;  // for its put_…
  for (int i = 0; i < pages; ++i) {
    link.bytes_.assign(page_size_, '\0');
    link.bytes_[0] = kInteriorIndexPage;
    link.put_16(5, static_cast<std::uint32_t>(page_size_));
    link.put_32(8, child);
    if (i + 1 < pages) child = append(link.bytes_);
  }
  bytes_.replace(at(root), page_size_, link.bytes_);
}

std::uint32_t ForgedFile::random_page(Random& random) const {
  return 1 + static_cast<std::uint32_t>(random.below(page_count()));
}

/// Where a cell begins, as the array of a random page says; somewhere in the page where it says nothing useful.
std::size_t ForgedFile::random_cell(Random& random) const {
  const std::uint32_t page = random_page(random);
  const std::size_t header = at(page) + (page == 1 ? kFileHeaderBytes : 0);
  const std::size_t header_bytes = bytes_[header] == 2 || bytes_[header] == kInteriorTablePage ? 12 : 8;
  const std::uint32_t cells = get_16(bytes_, header + 3);
  const std::size_t pointer = header + header_bytes + 2 * random.below(std::max<std::uint32_t>(1, cells));
  const std::size_t offset = pointer + 1 < bytes_.size() ? get_16(bytes_, pointer) : 0;
  return std::min(at(page) + std::min(offset, page_size_ - 1), bytes_.size() - 8);
}

void ForgedFile::change_at_random(Random& random) {
  const std::uint32_t page = random_page(random);
  const std::size_t header = at(page) + (page == 1 ? kFileHeaderBytes : 0);
  const std::uint32_t other = random_page(random);
  switch (random.below(12)) {
    case 0:  // a child that is any page
      put_32(random_cell(random), other);
      break;
    case 1:  // the last child
      put_32(header + 8, other);
      break;
    case 2:
      if (page != 1) bytes_.replace(at(page), page_size_, bytes_.substr(at(other), page_size_));
      break;
    case 3:
      if (page != 1) read_in_circles(page, 1 + static_cast<int>(random.below(4)));
      break;
    case 4:  // where a cell begins
      put_16(header + 8 + 2 * random.below(32), static_cast<std::uint32_t>(random.below(page_size_)));
      break;
    case 5:  // how many cells
      put_16(header + 3, static_cast<std::uint32_t>(random.below(page_size_ / 2)));
      break;
    case 6: {  // a longer payload, which flows over into any page
      const std::size_t cell = random_cell(random);
      bytes_[cell] = static_cast<char>(0x80 | random.below(128));
      bytes_[cell + 1] = static_cast<char>(0x80 | random.below(128));
      bytes_[cell + 2] = static_cast<char>(random.below(128));
      const std::size_t end = std::min(cell + random.below(page_size_), bytes_.size() - 4);
      put_32(end, other);
      break;
    }
    case 7: {  // the first page of an overflow chain, or a node of an R-tree: any number where a number may stand
      const std::size_t place = random_cell(random);
      put_32(std::min(place + 4 * random.below(page_size_ / 4), bytes_.size() - 4), random.below(2) == 0 ? other : 1);
      break;
    }
    case 8: {  // in the first pages stands the schema
      const std::string_view word = kWords.at(random.below(kWords.size()));
      const std::size_t place = random.below(std::min(bytes_.size(), 24 * page_size_) - word.size());
      bytes_.replace(std::max(place, kFileHeaderBytes), word.size(), word);
      break;
    }
    case 9:  // fields of the header that no check of the whole file's size stops
      bytes_.at(18 + random.below(kFileHeaderBytes - 18)) = static_cast<char>(random.below(256));
      break;
    case 10: {  // types in the header of a record: small numbers behind the length of the cell
      const std::size_t cell = random_cell(random);
      bytes_.at(std::min(cell + 2 + random.below(16), bytes_.size() - 1)) = static_cast<char>(random.below(16));
      break;
    }
    default: {
      const std::size_t place = random.below(bytes_.size());
      bytes_[place] = static_cast<char>(bytes_[place] ^ (1 << random.below(8)));
      break;
    }
  }
}

std::string bytes_in_circles(const std::filesystem::path& file, const std::string& table, int depth) {
  std::int64_t root = 1;
  if (table != "sqlite_master") {
    root = Database::open_untrusted(file, kMaxMapBlobBytes)
               .query_integer("SELECT rootpage FROM sqlite_master WHERE name = '" + table + "'");
  }
  ForgedFile forged(read_file(file));
  forged.read_in_circles(static_cast<std::uint32_t>(root), depth);
  return forged.bytes();
}

}  // namespace pilotage::testing
