#pragma once

namespace pilotage::scene_detail {

/// Red, green, blue on the 0 … 255 scale of the finished picture, before light and exposure.
struct Rgb {
  float r = 0;
  float g = 0;
  float b = 0;
};

inline Rgb operator*(const Rgb& c, float k) {
  return {c.r * k, c.g * k, c.b * k};
}
inline Rgb operator*(const Rgb& a, const Rgb& b) {
  return {a.r * b.r, a.g * b.g, a.b * b.b};
}
inline Rgb operator+(const Rgb& a, const Rgb& b) {
  return {a.r + b.r, a.g + b.g, a.b + b.b};
}
inline Rgb blend(const Rgb& a, const Rgb& b, float t) {
  return {a.r + (b.r - a.r) * t, a.g + (b.g - a.g) * t, a.b + (b.b - a.b) * t};
}

}  // namespace pilotage::scene_detail
