#include "nonnegative_factors.h"

#include <algorithm>
#include <cmath>

namespace haarlight::brdf {
namespace {

constexpr float tiny = 1e-20F;

/// Ramps centred at evenly spaced rows; positive, since the updates keep zeros.
Matrix ramps(std::size_t rows, std::size_t terms) {
  Matrix f(rows, terms);
  const float spacing = static_cast<float>(rows) / static_cast<float>(terms);
  for (std::size_t r = 0; r < rows; ++r)
    for (std::size_t j = 0; j < terms; ++j) {
      const float centre = (static_cast<float>(j) + 0.5F) * spacing;
      const float distance = std::abs(static_cast<float>(r) + 0.5F - centre) / spacing;
      f.row(r)[j] = std::max(0.01F, 1 - distance);
    }
  return f;
}

std::vector<float> column_sums(const Matrix& m) {
  std::vector<double> sums(m.columns);
  for (std::size_t r = 0; r < m.rows; ++r)
    for (std::size_t c = 0; c < m.columns; ++c)
      sums[c] += static_cast<double>(m.row(r)[c]);
  return {sums.begin(), sums.end()};
}

/// Adds factor · from to `to`, element by element.
void add(std::span<float> to, float factor, std::span<const float> from) {
  for (std::size_t j = 0; j < to.size(); ++j)
    to[j] += factor * from[j];
}

float product(std::span<const float> a, std::span<const float> b) {
  float sum = tiny;
  for (std::size_t j = 0; j < a.size(); ++j)
    sum += a[j] * b[j];
  return sum;
}

/// factors ∘ gradient / totals.
void scale(Matrix& factors, const Matrix& gradient, std::span<const float> totals) {
  for (std::size_t r = 0; r < factors.rows; ++r)
    for (std::size_t j = 0; j < factors.columns; ++j)
      factors.row(r)[j] *= gradient.row(r)[j] / std::max(totals[j], tiny);
}

void update_f(const Matrix& y, Matrix& f, const Matrix& g) {
  Matrix gradient(f.rows, f.columns);
  for (std::size_t r = 0; r < y.rows; ++r)
    for (std::size_t c = 0; c < y.columns; ++c)
      add(gradient.row(r), y.row(r)[c] / product(f.row(r), g.row(c)), g.row(c));
  scale(f, gradient, column_sums(g));
}

void update_g(const Matrix& y, const Matrix& f, Matrix& g) {
  Matrix gradient(g.rows, g.columns);
  for (std::size_t r = 0; r < y.rows; ++r)
    for (std::size_t c = 0; c < y.columns; ++c)
      add(gradient.row(c), y.row(r)[c] / product(f.row(r), g.row(c)), f.row(r));
  scale(g, gradient, column_sums(f));
}

/// Y's rows weighted by each term.
Matrix weighted_rows(const Matrix& y, const Matrix& f) {
  Matrix g(y.columns, f.columns);
  for (std::size_t r = 0; r < y.rows; ++r)
    for (std::size_t c = 0; c < y.columns; ++c)
      add(g.row(c), y.row(r)[c], f.row(r));
  return g;
}

void move_scale_to_f(NonnegativeFactors& factors) {
  const std::vector<float> sums = column_sums(factors.g);
  for (std::size_t j = 0; j < sums.size(); ++j) {
    for (std::size_t r = 0; r < factors.f.rows; ++r)
      factors.f.row(r)[j] *= sums[j];
    for (std::size_t c = 0; c < factors.g.rows; ++c)
      factors.g.row(c)[j] /= std::max(sums[j], tiny);
  }
}

} // namespace

NonnegativeFactors factorise(const Matrix& y, std::size_t terms, int iterations) {
  NonnegativeFactors factors;
  factors.f = ramps(y.rows, terms);
  factors.g = weighted_rows(y, factors.f);
  update_f(y, factors.f, factors.g);
  for (int i = 0; i < iterations; ++i) {
    update_g(y, factors.f, factors.g);
    update_f(y, factors.f, factors.g);
  }
  move_scale_to_f(factors);
  return factors;
}

} // namespace haarlight::brdf
