#pragma once

#include <algorithm>
#include <atomic>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include <pybind11/pybind11.h>
#include <sys/types.h>

#include "pilotage/base/options.h"
#include "pilotage/mapdb/map_reader.h"

namespace pilotage::python {

/// A MapReader for any number of Python's threads, one at a time.
class SharedMap {
 public:
  explicit SharedMap(MapReader opened);

  /// For what never changes: info, levels, camera.
  const MapReader& reader() const { return reader_; }

  /// Calls `work` with the reader, without the interpreter's lock, which is let go before the map's own is taken.
  /// `work` may take it back for a while, as matching does to have Python's handlers of signals run: they find the map
  /// in use, which is a UsageError, and so does a process that was forked from the one that opened it.
  template <class Work>
  auto use(const Work& work) {
    return use_all({this}, [&](std::span<MapReader* const> readers) { return work(*readers.front()); });
  }

  /// The same with the readers of several maps, in the order given; none may stand there twice.
  template <class Work>
  static auto use_all(const std::vector<SharedMap*>& maps, const Work& work) {
    for (const SharedMap* const map : maps) map->refuse_use();
    const pybind11::gil_scoped_release released;
    // Threads that use the same maps in another order must not wait for each other.
    std::vector<SharedMap*> in_one_order = maps;
    std::sort(in_one_order.begin(), in_one_order.end(), std::less<>());
    std::deque<InUse> in_use;
    for (SharedMap* const map : in_one_order) in_use.emplace_back(*map);
    std::vector<MapReader*> readers;
    for (SharedMap* const map : maps) readers.push_back(&map->reader_);
    return work(std::span<MapReader* const>(readers));
  }

 private:
  struct InUse {
    explicit InUse(SharedMap& of) : lock(of.mutex_), owner(of.owner_) { owner = std::this_thread::get_id(); }
    ~InUse() { owner = std::thread::id{}; }
    InUse(const InUse&) = delete;
    InUse& operator=(const InUse&) = delete;

    std::lock_guard<std::mutex> lock;
    std::atomic<std::thread::id>& owner;
  };

  void refuse_use() const;

  MapReader reader_;
  std::mutex mutex_;
  std::atomic<std::thread::id> owner_{};
  pid_t process_;
};

/// A text of the library's as Python has it; bytes that are no UTF-8, of the names of files, as os.fsdecode has them.
pybind11::str python_text(const std::string& text);

/// Takes the values of keyword arguments into described options. Throws TypeError for a name that is none of them or a
/// value of another type, UsageError for one that is not allowed.
void set_options(const OptionList& options, const pybind11::kwargs& values, const std::string& function);

/// A line for each option: name, meaning, limits, default.
std::string options_docstring(const OptionList& options);

void bind_camera(pybind11::module_& module);
void bind_map(pybind11::module_& module);
void bind_match(pybind11::module_& module);

}  // namespace pilotage::python
