#pragma once
// Importance sampling of a reflectance as a sum of products of one-dimensional densities: Lawrence,
// Rusinkiewicz and Ramamoorthi 2004, "Efficient BRDF Importance Sampling Using a Factored
// Representation".
//
// The matrix Y holds f_r(ω_o, ω_i) cos θ_i · 4 (ω_o·h), the density that half vectors h of a
// sampled reflectance have, integrated over cells of h; rows are θ_o at φ_o = 0, which suffices for
// isotropic reflectance, columns are cells of (θ_h, φ_h). It is factorised into F(θ_o) G(θ_h, φ_h),
// J terms, and each G into u(θ_h) v(φ_h), K terms. A sample chooses one of the J·K terms by F at
// its ω_o, then θ_h by u and φ_h by v, and mirrors ω_o about h.
//
// Local frame: z = the normal; ω_o lies in the half plane x ≥ 0, y = 0. Cells of θ_h divide
// sqrt(sin(θ_h/2)) evenly, much like the bins of a MERL table; φ_h and −φ_h share a cell.
//
// Unlike in the paper, rows of Y are normalised, so that dark views are fitted as well as bright
// ones; a small fraction of the samples is cosine-weighted, so that the density is positive
// wherever the reflectance is; and the density is exactly that of the samples, independent of the
// error of the factorisation.

#include <wavelet/base/geometry.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace haarlight::brdf {

// Non-negative matrix factorisation (Lee and Seung 2000, "Algorithms for non-negative matrix
// factorization").

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

struct FactorOptions {
  int views = 32;      ///< cells of θ_o
  int theta = 90;      ///< cells of θ_h
  int phi = 16;        ///< cells of |φ_h|
  int outer = 5;       ///< J
  int inner = 3;       ///< K; J·K at most FactoredBrdf::max_terms
  int iterations = 60; ///< of each factorisation
};

class FactoredBrdf {
public:
  static constexpr int max_terms = 16;

  /// Fraction of the samples that are cosine-weighted.
  static constexpr float cosine_fraction = 1.0F / 16;

  /// Sets f_r · max(0, cos θ_i), in luminance, for directions ω_i and one ω_o. Called from several
  /// threads.
  using Evaluate = std::function<void(const Vec3& local_wo, std::span<const Vec3> local_wi,
                                      std::span<float> out)>;

  explicit FactoredBrdf(const Evaluate& evaluate, const FactorOptions& options = {});

  /// The terms for one outgoing direction.
  struct View {
    Vec3 wo = Vec3::UnitZ();
    std::array<float, max_terms> weights{}; ///< probabilities of the terms
  };

  struct Sample {
    Vec3 direction; ///< unit; may lie below the horizon, where nothing is reflected
    float pdf = 0;  ///< sr⁻¹
  };

  /// @param local_wo unit, above the horizon but for rounding, y = 0
  View view(const Vec3& local_wo) const;

  /// Draws ω_i for a point of [0, 1)².
  Sample sample(const View& view, const Vec2& u) const;

  /// Density of sample() at a unit direction, sr⁻¹; its integral over the sphere is one.
  float pdf(const View& view, const Vec3& local_wi) const;

private:
  struct Cell {
    std::size_t theta = 0;
    std::size_t phi = 0;
  };

  /// One-dimensional densities of all terms.
  struct Densities {
    std::size_t cells = 0;
    std::vector<std::uint16_t> guide; ///< by term, the cells in which equal parts of the cdf begin
    std::vector<float> cdf;           ///< by term, cells + 1 each
    std::vector<float> density;       ///< by cell, max_terms each: probability over measure

    /// Chooses a cell of a term, and rescales u to [0, 1) within it.
    std::size_t choose(std::size_t term, float& u) const;
  };

  static Densities densities(std::span<const std::vector<float>> terms,
                             std::span<const float> measures);
  void factor(const Evaluate& evaluate);
  std::vector<float> row_of(const Evaluate& evaluate, int view) const;
  float edge(std::size_t theta_cell) const;
  std::vector<float> ring_areas() const;
  std::size_t choose_term(const View& view, float& u) const;
  Cell cell_of(const Vec3& h) const;
  float half_vector_density(const View& view, const Cell& cell) const;
  float density(const View& view, const Vec3& wi, const Cell& cell, float cos_d) const;

  FactorOptions m_options;
  std::vector<float> m_weights; ///< F by view, max_terms each
  Densities m_theta;
  Densities m_phi;
};

} // namespace haarlight::brdf
