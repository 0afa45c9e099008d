#include "pilotage/mapdb/tile_cache.h"

namespace pilotage {

std::size_t TileCache::bytes_of(const TileDescriptors& row) {
  return sizeof(row) + row.features.features.size() * sizeof(Feature) + row.features.descriptors.size() +
         row.ground_height_m.size() * sizeof(float);
}

std::size_t TileCache::bytes_of(const DecodedChip& row) {
  return sizeof(row) + row.picture.steps.total() + row.picture.valid.total();
}

const TileCache::AnyRow* TileCache::find(const Key& key) {
  const auto place = places_.find(key);
  if (place == places_.end()) return nullptr;
  entries_.splice(entries_.begin(), entries_, place->second);
  return &place->second->row;
}

void TileCache::keep(const Key& key, AnyRow row, std::size_t bytes) {
  if (bytes > max_bytes_) return;
  while (bytes_ + bytes > max_bytes_) {
    bytes_ -= entries_.back().bytes;
    places_.erase(entries_.back().key);
    entries_.pop_back();
  }
  entries_.push_front({key, std::move(row), bytes});
  places_.emplace(key, entries_.begin());
  bytes_ += bytes;
}

}  // namespace pilotage
