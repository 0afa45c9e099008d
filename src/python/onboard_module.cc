#include "onboard_module.h"

#include <exception>
#include <utility>

#include <unistd.h>

#include "pilotage/base/error.h"
#include "pilotage/base/progress.h"
#include "pilotage/base/text.h"

namespace py = pybind11;

namespace pilotage::python {
namespace {

OptionValue value_of(const std::string& name, const OptionField& field, const py::handle& value) {
  const std::string type = py::str(py::type::of(value).attr("__name__"));
  const std::string module = py::str(py::type::of(value).attr("__module__"));
  const bool is_bool = py::isinstance<py::bool_>(value) || (module == "numpy" && (type == "bool_" || type == "bool"));
  switch (field.type) {
    case OptionType::kBool:
      if (is_bool) return value.cast<bool>();
      throw py::type_error(name + " must be True or False, not " + type);
    case OptionType::kInteger:
      if (!is_bool && PyIndex_Check(value.ptr()) != 0) return py::int_(value.attr("__index__")()).cast<std::int64_t>();
      throw py::type_error(name + " must be an integer, not " + type);
    case OptionType::kNumber:
      if (!is_bool && py::hasattr(value, "__float__"))
        return py::float_(py::reinterpret_borrow<py::object>(value)).cast<double>();
      throw py::type_error(name + " must be a number, not " + type);
    default:
      if (py::isinstance<py::str>(value)) return value.cast<std::string>();
      throw py::type_error(name + " must be a string, not " + type);
  }
}

std::string limits_of(const OptionField& field) {
  std::string limits;
  if (field.range) limits = format_number(field.range->min) + " to " + format_number(field.range->max);
  const std::string by_default = option_to_text(field.default_value);
  if (!by_default.empty()) limits += (limits.empty() ? "" : "; ") + ("default " + by_default);
  return limits.empty() ? "" : " [" + limits + "]";
}

}  // namespace

SharedMap::SharedMap(MapReader opened) : reader_(std::move(opened)), process_(getpid()) {}

void SharedMap::refuse_use() const {
  if (getpid() != process_) {
    throw UsageError(reader_.name() + ": was opened before this process was forked; open it again");
  }
  if (owner_ == std::this_thread::get_id()) {
    throw UsageError(reader_.name() +
                     ": is being matched by this thread, and a handler of a signal may not use it meanwhile");
  }
}

py::str python_text(const std::string& text) {
  PyObject* const decoded = PyUnicode_DecodeUTF8(text.data(), static_cast<py::ssize_t>(text.size()), "surrogateescape");
  if (decoded == nullptr) throw py::error_already_set();
  return py::reinterpret_steal<py::str>(decoded);
}

void set_options(const OptionList& options, const py::kwargs& values, const std::string& function) {
  for (const auto& [key, value] : values) {
    const auto name = key.cast<std::string>();
    const OptionField* const field = options.find(name);
    if (field == nullptr) throw py::type_error(function + "() got an unexpected keyword argument '" + name + "'");
    if (!value.is_none()) field->set(value_of(name, *field, value));  // None: not given
  }
}

std::string options_docstring(const OptionList& options) {
  std::string text;
  for (const OptionField& field : options.fields) {
    text += "    " + field.path + ": " + field.help + limits_of(field) + "\n";
  }
  return text;
}

}  // namespace pilotage::python

PYBIND11_MODULE(_onboard, module) {
  using namespace pilotage;
  module.doc() = "What flies: maps, cameras and the matcher of pilotage/onboard.h.";

  // The classes of pilotage/errors.py, one for each kind that the library throws. They live as long as the module does.
  static const py::object* errors = new py::object(py::module_::import("pilotage.errors"));
  py::register_exception_translator([](std::exception_ptr thrown) {
    const auto raise = [](const char* kind, const std::exception& error) {
      PyErr_SetObject(errors->attr(kind).ptr(), python::python_text(error.what()).ptr());
    };
    try {
      if (thrown) std::rethrow_exception(std::move(thrown));
    } catch (const UsageError& error) {
      raise("UsageError", error);
    } catch (const IntegrityError& error) {
      raise("IntegrityError", error);
    } catch (const DataError& error) {
      raise("DataError", error);
    } catch (const Interrupted&) {
      // The signal's own exception, KeyboardInterrupt, is set by whoever asked the work to end.
      if (PyErr_Occurred() == nullptr) PyErr_SetString(errors->attr("Interrupted").ptr(), "interrupted");
    }
  });

  python::bind_camera(module);
  python::bind_map(module);
  python::bind_match(module);
}
