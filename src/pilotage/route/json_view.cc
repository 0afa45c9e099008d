#include "pilotage/route/json_view.h"

#include <cmath>
#include <limits>

#include "pilotage/base/error.h"
#include "pilotage/base/text.h"

namespace pilotage {

void JsonView::fail(const std::string& expectation) const {
  std::string shown = json_->dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
  if (shown.size() > 60) shown = shown.substr(0, 57) + "...";
  throw DataError(where_ + " = " + shown + ": expected " + expectation);
}

void JsonView::require_object() const {
  if (!json_->is_object()) fail("an object");
}

JsonView JsonView::at(const std::string& key) const {
  require_object();
  const auto it = json_->find(key);
  if (it == json_->end()) throw DataError(where_ + ": \"" + key + "\" is missing");
  return {*it, where_ + "." + key};
}

std::optional<JsonView> JsonView::find(const std::string& key) const {
  require_object();
  const auto it = json_->find(key);
  if (it == json_->end() || it->is_null()) return std::nullopt;
  return JsonView{*it, where_ + "." + key};
}

JsonView JsonView::at(std::size_t index) const {
  if (index >= size()) fail("at least " + std::to_string(index + 1) + " elements");
  return {(*json_)[index], where_ + "[" + std::to_string(index) + "]"};
}

std::size_t JsonView::size() const {
  if (!json_->is_array()) fail("a list");
  return json_->size();
}

double JsonView::number() const {
  if (!json_->is_number()) fail("a number");
  const double value = json_->get<double>();
  if (!std::isfinite(value)) fail("a finite number");
  return value;
}

double JsonView::number_or_nan() const {
  return json_->is_null() ? std::numeric_limits<double>::quiet_NaN() : number();
}

int JsonView::integer() const {
  const double value = number();
  if (value != std::floor(value) || std::abs(value) > std::numeric_limits<int>::max()) fail("an integer");
  return static_cast<int>(value);
}

bool JsonView::boolean() const {
  if (!json_->is_boolean()) fail("true or false");
  return json_->get<bool>();
}

std::string JsonView::text() const {
  if (!json_->is_string()) fail("a string");
  return json_->get<std::string>();
}

}  // namespace pilotage
