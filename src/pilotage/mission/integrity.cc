#include "pilotage/mission/integrity.h"

#include <cmath>

#include <nlohmann/json.hpp>

#include "pilotage/base/json_object.h"
#include "pilotage/base/nan.h"
#include "pilotage/base/text.h"

namespace pilotage {

double integrity_sigma_multiple() {
  return std::sqrt(-2 * std::log(kBeyondBound));
}

void IntegrityCount::look(double weight, double sigma_m, double error_m, double limit_m) {
  looked_ += weight;
  stretch_ += weight;
  if (!(integrity_sigma_multiple() * sigma_m <= limit_m)) return;
  clear_ += weight;
  if (!(error_m <= limit_m)) misled_ += weight;
}

void IntegrityCount::end_stretch() {
  squares_ += stretch_ * stretch_;
  stretch_ = 0;
}

void IntegrityCount::add(const IntegrityCount& other) {
  looked_ += other.looked_;
  clear_ += other.clear_;
  misled_ += other.misled_;
  squares_ += other.squares_ + other.stretch_ * other.stretch_;
}

Integrity IntegrityCount::result(double limit_m) const {
  Integrity result;
  result.limit_m = limit_m;
  result.looked = looked_;
  const double squares = squares_ + stretch_ * stretch_;
  if (!(looked_ > 0)) {
    result.clear_share = result.misled_share = kNaN;
    result.misled = {0, 1};
    return result;
  }
  result.clear_share = clear_ / looked_;
  result.misled_share = misled_ / looked_;
  constexpr double kRounding = 1e-9;  // equal stretches count as many as they are
  result.stretches = static_cast<std::int64_t>(std::floor(looked_ * looked_ / squares * (1 + kRounding)));
  const double wrong = result.misled_share * static_cast<double>(result.stretches);
  const auto at_least = static_cast<std::int64_t>(std::floor(wrong));
  const auto at_most = static_cast<std::int64_t>(std::ceil(wrong));
  result.misled = {binomial_interval(at_least, result.stretches).low,
                   binomial_interval(at_most, result.stretches).high};
  return result;
}

nlohmann::ordered_json integrity_to_json(const Integrity& integrity) {
  return {{"limit_m", integrity.limit_m},
          {"p_beyond_bound", kBeyondBound},
          {"sigma_multiple", integrity_sigma_multiple()},
          {"looked", integrity.looked},
          {"clear_share", json_number(integrity.clear_share)},
          {"misled_share", json_number(integrity.misled_share)},
          {"misled_low", integrity.misled.low},
          {"misled_high", integrity.misled.high},
          {"stretches", integrity.stretches}};
}

Integrity integrity_from_json(JsonObject json) {
  Integrity integrity;
  integrity.limit_m = json.number("limit_m");
  json.number("p_beyond_bound");
  json.number("sigma_multiple");
  integrity.looked = json.number("looked");
  integrity.clear_share = json.number_or_nan("clear_share");
  integrity.misled_share = json.number_or_nan("misled_share");
  integrity.misled = {json.number("misled_low"), json.number("misled_high")};
  integrity.stretches = json.integer("stretches", 0);
  json.finish();
  return integrity;
}

std::string integrity_text(const Integrity& integrity) {
  if (!(integrity.looked > 0)) return "integrity: nothing was looked at without GNSS";
  return "integrity: all clear (" + format_fixed(integrity_sigma_multiple(), 2) + " sigma of the filter within " +
         format_number(integrity.limit_m) + " m, which an honest error exceeds with at most " +
         format_number(kBeyondBound) + ") for " + format_fixed(integrity.clear_share, 3) +
         " of the flight, and wrong for " + format_fixed(integrity.misled_share, 5) + " [" +
         format_fixed(integrity.misled.low, 5) + ", " + format_fixed(integrity.misled.high, 5) + "] of it, by " +
         std::to_string(integrity.stretches) + " stretches between fixes";
}

}  // namespace pilotage
