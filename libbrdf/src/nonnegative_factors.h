#pragma once
// Non-negative matrix factorisation (Lee and Seung 2000, "Algorithms for non-negative matrix
// factorization").

#include <cstddef>
#include <span>
#include <vector>

namespace haarlight::brdf {

/// Row-major.
struct Matrix {
  std::size_t rows = 0;
  std::size_t columns = 0;
  std::vector<float> values;

  Matrix() = default;
  Matrix(std::size_t r, std::size_t c) : rows(r), columns(c), values(r * c) {}

  std::span<float> row(std::size_t r) { return std::span(values).subspan(r * columns, columns); }
  std::span<const float> row(std::size_t r) const {
    return std::span(values).subspan(r * columns, columns);
  }
};

/// Y ≈ F Gᵀ, nothing negative.
struct NonnegativeFactors {
  Matrix f; ///< rows of Y × terms; takes the scale
  Matrix g; ///< columns of Y × terms, each of which sums to one (or is zero)
};

/// Multiplicative updates that reduce the divergence of F Gᵀ from Y (their eq. 5) and preserve the
/// sums of Y's rows. Initial terms represent neighbouring rows.
NonnegativeFactors factorise(const Matrix& y, std::size_t terms, int iterations);

} // namespace haarlight::brdf
