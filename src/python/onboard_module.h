#pragma once

#include <memory>
#include <mutex>
#include <string>

#include <pybind11/pybind11.h>

#include "pilotage/base/options.h"
#include "pilotage/mapdb/map_reader.h"

namespace pilotage::python {

/// A MapReader for any number of Python's threads, one at a time. The interpreter's lock is let go before `mutex` is
/// taken, and taken again after `mutex` is let go: a thread that waits for one never holds the other.
struct SharedMap {
  explicit SharedMap(MapReader opened) : reader(std::move(opened)) {}

  MapReader reader;
  std::mutex mutex;
};

/// Calls `work` with the reader, without the interpreter's lock: it must not touch anything of Python's.
template <class Work>
auto with_reader(SharedMap& map, const Work& work) {
  const pybind11::gil_scoped_release released;
  const std::lock_guard lock(map.mutex);
  return work(map.reader);
}

/// Takes the values of keyword arguments into described options. Throws TypeError for a name that is none of them or a
/// value of another type, UsageError for one that is not allowed.
void set_options(const OptionList& options, const pybind11::kwargs& values, const std::string& function);

/// A line for each option: name, meaning, limits, default.
std::string options_docstring(const OptionList& options);

void bind_camera(pybind11::module_& module);
void bind_map(pybind11::module_& module);
void bind_match(pybind11::module_& module);

}  // namespace pilotage::python
