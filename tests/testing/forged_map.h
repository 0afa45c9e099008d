#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "pilotage/base/random.h"

namespace pilotage::testing {

/// An SQLite file that is changed where its structure is (sqlite.org/fileformat2.html): what a forger of maps does, and
/// what changes of random bytes hardly ever reach.
class ForgedFile {
 public:
  /// `bytes` is a sound file; throws std::invalid_argument when it is none.
  explicit ForgedFile(std::string bytes);

  const std::string& bytes() const { return bytes_; }
  std::uint32_t page_count() const;

  /// Makes page `root` an interior page of a table, all of whose children are one page that is itself such a page, and
  /// so on, `depth` deep; the innermost is what `root` was. A few hundred bytes a level, hundreds of times the rows.
  void read_in_circles(std::uint32_t root, int depth);

  /// Puts `pages` interior pages of an index before page `root`, each with one child: the next.
  void lengthen_index(std::uint32_t root, int pages);

  /// One change of a random kind: pages copied, exchanged, named as children, cells moved, lengthened or sent to the
  /// overflow of others, words of SQL put into text, fields of the header, bytes.
  void change_at_random(Random& random);

 private:
  std::size_t at(std::uint32_t page) const { return (page - 1) * page_size_; }
  std::uint32_t random_page(Random& random) const;
  std::size_t random_cell(Random& random) const;
  void put_16(std::size_t at, std::uint32_t value);
  void put_32(std::size_t at, std::uint32_t value);
  std::uint32_t append(const std::string& page);
  std::string interior_page(std::uint32_t child, std::size_t header) const;

  std::string bytes_;
  std::size_t page_size_ = 0;
};

/// The bytes of a sound SQLite file, the pages of whose table ("sqlite_master", too) lead in circles below its root.
std::string bytes_in_circles(const std::filesystem::path& file, const std::string& table, int depth);

}  // namespace pilotage::testing
