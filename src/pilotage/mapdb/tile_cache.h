#pragma once

#include <cstddef>
#include <cstdint>
#include <list>
#include <map>
#include <memory>
#include <optional>
#include <tuple>
#include <utility>
#include <variant>

#include "pilotage/mapdb/chip_codec.h"
#include "pilotage/mapdb/map_types.h"

#pragma GCC visibility push(default)

namespace pilotage {

/// A chip of the map as pixels.
struct DecodedChip {
  PixelWindow window;  ///< MapChip::window.
  ChipPicture picture;
};

/// Decoded rows of a map, so that frames that overlap do not decode their tiles again: the lately used ones, of
/// together at most `max_bytes`. Nothing in it depends on time or chance. Not for use by two threads at a time; the
/// rows it hands out are constant, outlive it, and may be read by any thread.
class TileCache {
 public:
  explicit TileCache(std::size_t max_bytes) : max_bytes_(max_bytes) {}

  /// The row of a tile and level, `Row` = TileDescriptors or DecodedChip; nullptr when the map has none. `read` is
  /// called when it is not held, and gives the row or nothing. What it throws is thrown on, and nothing is kept.
  template <class Row, class Read>
  std::shared_ptr<const Row> get(std::int64_t tile_id, int level, const Read& read) {
    using Pointer = std::shared_ptr<const Row>;
    const Key key{std::is_same_v<Row, DecodedChip>, tile_id, level};
    if (const AnyRow* const held = find(key)) return std::get<Pointer>(*held);
    std::optional<Row> row = read();
    const Pointer pointer = row ? std::make_shared<const Row>(std::move(*row)) : nullptr;
    keep(key, pointer, sizeof(Entry) + (pointer ? bytes_of(*pointer) : 0));
    return pointer;
  }

  /// Of the rows that are held: at most max_bytes.
  std::size_t bytes() const { return bytes_; }

  static std::size_t bytes_of(const TileDescriptors& row);
  static std::size_t bytes_of(const DecodedChip& row);

 private:
  using Key = std::tuple<bool, std::int64_t, int>;  // is it a chip; tile_id; level
  using AnyRow = std::variant<std::shared_ptr<const TileDescriptors>, std::shared_ptr<const DecodedChip>>;
  struct Entry {
    Key key;
    AnyRow row;
    std::size_t bytes;
  };

  const AnyRow* find(const Key& key);
  void keep(const Key& key, AnyRow row, std::size_t bytes);

  std::size_t max_bytes_;
  std::size_t bytes_ = 0;
  std::list<Entry> entries_;  // lately used ones first
  std::map<Key, std::list<Entry>::iterator> places_;
};

}  // namespace pilotage

#pragma GCC visibility pop
