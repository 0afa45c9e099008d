#pragma once

#include <stdexcept>

#pragma GCC visibility push(default)

namespace pilotage {

/// The caller asked for something that is not allowed: an unknown option, a value outside its range, options that
/// exclude each other. The command line exits with 2.
class UsageError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The input or the machine does not allow what was asked: an unreadable raster, a damaged map, a full disk.
/// The command line exits with 1.
class DataError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A digest or a signature is wrong, or a map is not the one that is asked for. The command line exits with 4.
class IntegrityError : public DataError {
 public:
  using DataError::DataError;
};

}  // namespace pilotage

#pragma GCC visibility pop
