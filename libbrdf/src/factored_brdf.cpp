#include <brdf/factored_brdf.h>

#include <wavelet/base/parallel.h>
#include <wavelet/base/sampling.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>

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

namespace {

constexpr float below_one = 0x1.fffffep-1F;
constexpr int taps = 2; ///< along either side of a cell

constexpr std::size_t guide_parts = 256; ///< of a cdf, with the cell each begins in

/// Appends the cells in which equal parts of a cdf begin.
void append_guide(std::span<const float> cdf, std::vector<std::uint16_t>& guide) {
  std::size_t cell = 0;
  for (std::size_t part = 0; part < guide_parts; ++part) {
    while (cdf[cell + 1] <= static_cast<float>(part) / guide_parts)
      ++cell;
    guide.push_back(static_cast<std::uint16_t>(cell));
  }
}

/// From 0 to 1, one number more than there are cells. @param cells sum to one
std::vector<float> cumulative(std::span<const float> cells) {
  std::vector<float> cdf = {0};
  double sum = 0;
  for (const float value : cells) {
    sum += static_cast<double>(value);
    cdf.push_back(std::min(static_cast<float>(sum), 1.0F));
  }
  cdf.back() = 1;
  return cdf;
}

/// Half vector of (1 − cos θ_h)/2 and φ_h.
Vec3 half_vector(float s, float phi) {
  float sine = 0;
  float cosine = 1;
  sine_cosine(phi, sine, cosine);
  const float sin_theta = 2 * std::sqrt(s * (1 - s));
  return {sin_theta * cosine, sin_theta * sine, 1 - 2 * s};
}

std::vector<float> column(const Matrix& m, std::size_t index) {
  std::vector<float> values(m.rows);
  for (std::size_t r = 0; r < m.rows; ++r)
    values[r] = m.row(r)[index];
  return values;
}

/// One column of cells (θ_h, φ_h), φ_h fastest, as a matrix of φ_h × θ_h.
Matrix image_of(std::span<const float> cells, std::size_t theta, std::size_t phi) {
  Matrix image(phi, theta);
  for (std::size_t i = 0; i < theta; ++i)
    for (std::size_t k = 0; k < phi; ++k)
      image.row(k)[i] = cells[i * phi + k];
  return image;
}

/// Scales to a sum of one; equal values if all are zero.
void normalise(std::span<float> values) {
  const double sum = std::accumulate(values.begin(), values.end(), 0.0);
  for (float& value : values)
    value = sum > 0 ? static_cast<float>(static_cast<double>(value) / sum)
                    : 1.0F / static_cast<float>(values.size());
}

} // namespace

FactoredBrdf::FactoredBrdf(const Evaluate& evaluate, const FactorOptions& options)
    : m_options(options) {
  assert(options.outer * options.inner <= max_terms);
  factor(evaluate);
}

/// (1 − cos θ_h)/2 where a cell of θ_h begins.
float FactoredBrdf::edge(std::size_t theta_cell) const {
  const float t = static_cast<float>(theta_cell) / static_cast<float>(m_options.theta);
  return 0.5F * t * t * t * t;
}

std::vector<float> FactoredBrdf::row_of(const Evaluate& evaluate, int view) const {
  const auto theta = static_cast<std::size_t>(m_options.theta);
  const auto phi = static_cast<std::size_t>(m_options.phi);
  Vec3 wo = Vec3::Zero();
  sine_cosine((static_cast<float>(view) + 0.5F) / static_cast<float>(m_options.views) * 0.5F * pi,
              wo.x(), wo.z());
  std::vector<float> row(theta * phi);
  std::vector<Vec3> wi(phi * taps * taps);
  std::vector<float> jacobian(wi.size());
  std::vector<float> values(wi.size());
  for (std::size_t i = 0; i < theta; ++i) {
    for (std::size_t n = 0; n < wi.size(); ++n) {
      const float along = (static_cast<float>(n % taps) + 0.5F) / taps;
      const std::size_t turn = n / taps;
      const float around = (static_cast<float>(turn) + 0.5F) / static_cast<float>(phi * taps);
      const float side = turn % 2 == 0 ? 1.0F : -1.0F; // both halves count
      const Vec3 h = half_vector(edge(i) + along * (edge(i + 1) - edge(i)), side * around * pi);
      wi[n] = mirror(wo, h);
      jacobian[n] = std::max(0.0F, wo.dot(h)) * (edge(i + 1) - edge(i));
    }
    evaluate(wo, wi, values);
    for (std::size_t n = 0; n < wi.size(); ++n)
      row[i * phi + n / (taps * taps)] += std::max(0.0F, values[n]) * jacobian[n];
  }
  normalise(row);
  return row;
}

FactoredBrdf::Densities FactoredBrdf::densities(std::span<const std::vector<float>> terms,
                                                std::span<const float> measures) {
  Densities result;
  result.cells = measures.size();
  result.density.resize(result.cells * max_terms);
  for (std::size_t l = 0; l < terms.size(); ++l) {
    const std::vector<float> cdf = cumulative(terms[l]);
    append_guide(cdf, result.guide);
    for (std::size_t i = 0; i < result.cells; ++i)
      result.density[i * max_terms + l] = (cdf[i + 1] - cdf[i]) / measures[i];
    result.cdf.insert(result.cdf.end(), cdf.begin(), cdf.end());
  }
  return result;
}

std::size_t FactoredBrdf::Densities::choose(std::size_t term, float& u) const {
  const float* c = &cdf[term * (cells + 1)];
  const auto part = static_cast<std::size_t>(u * guide_parts);
  std::size_t cell = guide[term * guide_parts + part];
  while (c[cell + 1] <= u)
    ++cell;
  u = std::min((u - c[cell]) / (c[cell + 1] - c[cell]), below_one);
  return cell;
}

void FactoredBrdf::factor(const Evaluate& evaluate) {
  const auto views = static_cast<std::size_t>(m_options.views);
  const auto theta = static_cast<std::size_t>(m_options.theta);
  const auto phi = static_cast<std::size_t>(m_options.phi);
  Matrix y(views, theta * phi);
  parallel_for(views, [&](std::size_t r) {
    std::ranges::copy(row_of(evaluate, static_cast<int>(r)), y.row(r).begin());
  });
  const auto outer = static_cast<std::size_t>(m_options.outer);
  const auto inner = static_cast<std::size_t>(m_options.inner);
  const NonnegativeFactors factors = factorise(y, outer, m_options.iterations);
  m_weights.resize(views * max_terms);
  std::vector<std::vector<float>> u;
  std::vector<std::vector<float>> v;
  for (std::size_t j = 0; j < outer; ++j) {
    const NonnegativeFactors parts =
        factorise(image_of(column(factors.g, j), theta, phi), inner, m_options.iterations);
    for (std::size_t k = 0; k < inner; ++k) {
      u.push_back(column(parts.g, k));
      v.push_back(column(parts.f, k));
      const float scale = std::accumulate(v.back().begin(), v.back().end(), 0.0F);
      for (std::size_t r = 0; r < views; ++r)
        m_weights[r * max_terms + u.size() - 1] = factors.f.row(r)[j] * scale;
      normalise(u.back());
      normalise(v.back());
    }
  }
  m_theta = densities(u, ring_areas());
  m_phi = densities(v, std::vector<float>(phi, 1.0F / static_cast<float>(phi)));
}

/// Steradian of each cell of θ_h.
std::vector<float> FactoredBrdf::ring_areas() const {
  std::vector<float> areas(static_cast<std::size_t>(m_options.theta));
  for (std::size_t i = 0; i < areas.size(); ++i)
    areas[i] = 4 * pi * (edge(i + 1) - edge(i));
  return areas;
}

FactoredBrdf::View FactoredBrdf::view(const Vec3& local_wo) const {
  const float cells = static_cast<float>(m_options.views);
  const float theta = arctangent(local_wo.x(), local_wo.z());
  const float place = std::clamp(theta * (2 / pi) * cells - 0.5F, 0.0F, cells - 1);
  const auto first = static_cast<std::size_t>(place);
  const std::size_t second = std::min(first + 1, static_cast<std::size_t>(m_options.views) - 1);
  const float blend = place - static_cast<float>(first);
  View result;
  result.wo = local_wo;
  for (std::size_t l = 0; l < max_terms; ++l) {
    const float a = m_weights[first * max_terms + l];
    result.weights[l] = a + (m_weights[second * max_terms + l] - a) * blend;
  }
  const auto terms =
      static_cast<std::size_t>(m_options.outer) * static_cast<std::size_t>(m_options.inner);
  normalise(std::span(result.weights).first(terms));
  return result;
}

FactoredBrdf::Sample FactoredBrdf::sample(const View& view, const Vec2& u) const {
  if (u.x() < cosine_fraction) {
    const Vec3 wi = sample_cosine_hemisphere({u.x() / cosine_fraction, u.y()});
    return {wi, pdf(view, wi)};
  }
  float rest = std::min((u.x() - cosine_fraction) / (1 - cosine_fraction), below_one);
  const std::size_t term = choose_term(view, rest);
  const float turn = 2 * u.y() - 1;
  float around = std::min(std::abs(turn), below_one);
  const Cell cell = {m_theta.choose(term, rest), m_phi.choose(term, around)};
  const float s = edge(cell.theta) + rest * (edge(cell.theta + 1) - edge(cell.theta));
  const float angle =
      (static_cast<float>(cell.phi) + around) * pi / static_cast<float>(m_phi.cells);
  const Vec3 h = half_vector(s, turn < 0 ? -angle : angle);
  const Vec3 wi = mirror(view.wo, h);
  return {wi, density(view, wi, cell, std::abs(view.wo.dot(h)))};
}

/// Rescales u to [0, 1) within the term.
std::size_t FactoredBrdf::choose_term(const View& view, float& u) const {
  const auto last = static_cast<std::size_t>(m_options.outer * m_options.inner) - 1;
  std::size_t term = 0;
  while (term < last && u >= view.weights[term])
    u -= view.weights[term++];
  u = std::min(u / std::max(view.weights[term], 1e-20F), below_one);
  return term;
}

FactoredBrdf::Cell FactoredBrdf::cell_of(const Vec3& h) const {
  const float s = (h.x() * h.x() + h.y() * h.y()) / (2 * (1 + h.z()));
  const float t = std::sqrt(std::sqrt(2 * s));
  const float phi = arctangent(std::abs(h.y()), h.x()) / pi;
  return {static_cast<std::size_t>(std::clamp(
              static_cast<int>(t * static_cast<float>(m_options.theta)), 0, m_options.theta - 1)),
          static_cast<std::size_t>(std::clamp(
              static_cast<int>(phi * static_cast<float>(m_options.phi)), 0, m_options.phi - 1))};
}

float FactoredBrdf::half_vector_density(const View& view, const Cell& cell) const {
  const float* u = &m_theta.density[cell.theta * max_terms];
  const float* v = &m_phi.density[cell.phi * max_terms];
  float sum = 0;
  for (std::size_t l = 0; l < max_terms; ++l)
    sum += view.weights[l] * u[l] * v[l];
  return sum;
}

float FactoredBrdf::density(const View& view, const Vec3& wi, const Cell& cell, float cos_d) const {
  const float mirrored = half_vector_density(view, cell) / (4 * std::max(cos_d, 1e-6F));
  return cosine_fraction * cosine_hemisphere_pdf(wi) + (1 - cosine_fraction) * mirrored;
}

float FactoredBrdf::pdf(const View& view, const Vec3& local_wi) const {
  Vec3 h = local_wi + view.wo;
  const float length = std::max(h.norm(), 1e-6F);
  h *= (h.z() < 0 ? -1.0F : 1.0F) / length;
  return density(view, local_wi, cell_of(h), 0.5F * length);
}

} // namespace haarlight::brdf
