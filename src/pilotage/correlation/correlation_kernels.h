#pragma once

#include <cstddef>

namespace pilotage {

// The inner loops of correlation, eight or sixteen numbers at a time, with AVX2 where the processor has it. Both
// versions do the same operations in the same order on the same lanes: they give the same bits.

/// out = Σ conj(a)·b over `terms` (at least 1) pairs of arrays of `count` complex numbers, a multiple of 8, that follow
/// each other; real and imaginary parts interleaved.
void multiply_conjugate_sum(const float* a, const float* b, std::size_t terms, std::size_t count, float* out);

/// out = ((a + b) + c) + d.
void add_four(const float* a, const float* b, const float* c, const float* d, std::size_t count, float* out);

/// values += more.
void add_to(const float* more, std::size_t count, float* values);

/// values[i] = (values[i] − mean·window_sum[step·i])·(scale·inverse_norm[step·i]), kept within ±1; step 1, 2 or 4.
void normalise(const float* window_sum, const float* inverse_norm, std::size_t step, float mean, float scale,
               std::size_t count, float* values);

/// For one row of a tile: sums[3·dy + dx] += Σ_i tile[i]·map[dy][i + dx], dx and dy in {0, 1, 2}.
void add_products_3x3(const float* tile, const float* const map[3], std::size_t count, double sums[9]);

/// Sums over the numbers that are not NaN, and the largest; −infinity when there is none.
struct SpanSums {
  double count = 0;
  double sum = 0;
  double squares = 0;
  float highest = 0;
};

/// Sixteen float sums, each over every sixteenth number, added in double: relative error below 1e-5 for spans of up to
/// 10,000 numbers within ±1.
SpanSums sum_span(const float* values, std::size_t count);

}  // namespace pilotage
