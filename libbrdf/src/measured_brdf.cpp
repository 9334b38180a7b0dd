#include <brdf/measured_brdf.h>

#include <wavelet/base/cpu_clones.h>

#include <wavelet/file/input_file.h>

#include <algorithm>
#include <span>

namespace haarlight::brdf {

const char* lookup_name(Lookup lookup) {
  return lookup == Lookup::Nearest ? "nearest" : "trilinear";
}

MeasuredBrdf::MeasuredBrdf(const std::string& path, Lookup lookup)
    : MeasuredBrdf(read_merl(path), lookup, base_name(path)) {}

MeasuredBrdf::MeasuredBrdf(const MerlTable& table, Lookup lookup, const std::string& name)
    : m_lookup(lookup), m_phi_d_bins(table.phi_d_bins), m_name(name),
      m_hash(hash_text(std::as_bytes(std::span(table.raw)))),
      m_cells(static_cast<std::size_t>(index(merl_theta_h_bins, 0, 0))) {
  fill(table);
  pad_rows();
}

void MeasuredBrdf::fill(const MerlTable& table) {
  std::size_t source = 0;
  std::size_t invalid = 0;
  std::array<std::size_t, 3> negative = {};
  for (int row = 0; row < merl_theta_h_bins * merl_theta_d_bins; ++row) {
    Cell* target = m_cells.data() + index(0, row, 1);
    for (int i = 0; i < m_phi_d_bins; ++i, ++source) {
      const double r = table.value(0, source);
      const double g = table.value(1, source);
      const double b = table.value(2, source);
      negative[0] += r >= 0 ? 0 : 1;
      negative[1] += g >= 0 ? 0 : 1;
      negative[2] += b >= 0 ? 0 : 1;
      if (r >= 0 && g >= 0 && b >= 0)
        target[i].value =
            Float4{static_cast<float>(r * merl_scale[0]), static_cast<float>(g * merl_scale[1]),
                   static_cast<float>(b * merl_scale[2]), 1.0F};
      else
        ++invalid;
    }
  }
  const auto cells = static_cast<double>(source);
  m_invalid_fraction = static_cast<double>(invalid) / cells;
  for (std::size_t c = 0; c < 3; ++c)
    m_negative_fractions[c] = static_cast<double>(negative[c]) / cells;
}

void MeasuredBrdf::pad_rows() {
  for (int row = 0; row < merl_theta_h_bins * merl_theta_d_bins; ++row) {
    Cell* cells = m_cells.data() + index(0, row, 0);
    cells[0] = cells[m_phi_d_bins];
    cells[m_phi_d_bins + 1] = cells[1];
  }
}

namespace {

/// Cells of one row of φ_d, padding included, in either kind of table.
int row_length(int phi_d_bins) { return phi_d_bins + 2; }

/// The cells of a look-up: the one of least indices, and the weights of the next ones.
struct Stencil {
  int cell;
  float theta_h, theta_d, phi_d;
};

Stencil nearest_stencil(const TablePosition<float>& place, int phi_d_bins) {
  const int ih = std::min(static_cast<int>(place.theta_h), merl_theta_h_bins - 1);
  const int id = std::min(static_cast<int>(place.theta_d), merl_theta_d_bins - 1);
  const int ip = std::min(static_cast<int>(place.phi_d), phi_d_bins - 1);
  return {(ih * merl_theta_d_bins + id) * row_length(phi_d_bins) + ip + 1, 0, 0, 0};
}

Stencil trilinear_stencil(const TablePosition<float>& place, int phi_d_bins) {
  const float h = smaller(larger(place.theta_h - 0.5F, 0.0F), merl_theta_h_bins - 1.0F);
  const float d = smaller(larger(place.theta_d - 0.5F, 0.0F), merl_theta_d_bins - 1.0F);
  const float p = place.phi_d + 0.5F; // counted in padded cells
  const int ih = std::min(static_cast<int>(h), merl_theta_h_bins - 2);
  const int id = std::min(static_cast<int>(d), merl_theta_d_bins - 2);
  const int ip = std::min(static_cast<int>(p), phi_d_bins);
  return {(ih * merl_theta_d_bins + id) * row_length(phi_d_bins) + ip, h - static_cast<float>(ih),
          d - static_cast<float>(id), p - static_cast<float>(ip)};
}

} // namespace

Float4 MeasuredBrdf::interpolate(int cell, float theta_h_weight, float theta_d_weight,
                                 float phi_d_weight) const {
  const int next_d = row_length(m_phi_d_bins);
  const Cell* near = m_cells.data() + cell;
  const Cell* far = near + next_d * merl_theta_d_bins;
  const auto lerp = [](Float4 a, Float4 b, float weight) { return a + weight * (b - a); };
  const auto row = [&](const Cell* c) { return lerp(c[0].value, c[1].value, phi_d_weight); };
  const Float4 sum = lerp(lerp(row(near), row(near + next_d), theta_d_weight),
                          lerp(row(far), row(far + next_d), theta_d_weight), theta_h_weight);
  return sum[3] > 1e-6F ? sum / sum[3] : Float4{};
}

Float4 MeasuredBrdf::at(const TablePosition<float>& place) const {
  if (m_lookup == Lookup::Nearest)
    return m_cells[static_cast<std::size_t>(nearest_stencil(place, m_phi_d_bins).cell)].value;
  const Stencil s = trilinear_stencil(place, m_phi_d_bins);
  return interpolate(s.cell, s.theta_h, s.theta_d, s.phi_d);
}

Rgb MeasuredBrdf::evaluate(const Vec3& local_wi, const Vec3& local_wo) const {
  if (!(local_wi.z() > 0 && local_wo.z() > 0))
    return Rgb::Zero();
  const float wi[3] = {local_wi.x(), local_wi.y(), local_wi.z()};
  const float wo[3] = {local_wo.x(), local_wo.y(), local_wo.z()};
  const Float4 value = at(table_position_of_one(half_difference(wi, wo), folded()));
  return {value[0], value[1], value[2]};
}

namespace {

HAARLIGHT_CPU_CLONES void half_differences(const DirectionBatch& in, HalfDifferenceBatch& out) {
  for (int i = 0; i < in.count; ++i) {
    const float wi[3] = {in.wi[0][i], in.wi[1][i], in.wi[2][i]};
    const float wo[3] = {in.wo[0][i], in.wo[1][i], in.wo[2][i]};
    const HalfDifference<float> angles = half_difference(wi, wo);
    out.theta_h_y[i] = angles.theta_h_y;
    out.theta_h_x[i] = angles.theta_h_x;
    out.theta_d_y[i] = angles.theta_d_y;
    out.theta_d_x[i] = angles.theta_d_x;
    out.phi_d_y[i] = angles.phi_d_y;
    out.phi_d_x[i] = angles.phi_d_x;
  }
}

struct StencilBatch {
  int cell[batch_capacity];
  float theta_h[batch_capacity], theta_d[batch_capacity], phi_d[batch_capacity];
};

HAARLIGHT_CPU_CLONES void find_stencils(const HalfDifferenceBatch& in, Lookup lookup,
                                        int phi_d_bins, StencilBatch& out) {
  for (int i = 0; i < in.count; ++i) {
    const HalfDifference<float> angles{in.theta_h_y[i], in.theta_h_x[i], in.theta_d_y[i],
                                       in.theta_d_x[i], in.phi_d_y[i],   in.phi_d_x[i]};
    const TablePosition<float> place = table_position(angles, phi_d_bins == merl_phi_d_bins);
    const Stencil s = lookup == Lookup::Nearest ? nearest_stencil(place, phi_d_bins)
                                                : trilinear_stencil(place, phi_d_bins);
    out.cell[i] = s.cell;
    out.theta_h[i] = s.theta_h;
    out.theta_d[i] = s.theta_d;
    out.phi_d[i] = s.phi_d;
  }
}

} // namespace

void MeasuredBrdf::evaluate(const HalfDifferenceBatch& batch, Float4* values) const {
  StencilBatch s;
  find_stencils(batch, m_lookup, m_phi_d_bins, s);
  if (m_lookup == Lookup::Nearest)
    for (int i = 0; i < batch.count; ++i)
      values[i] = m_cells[static_cast<std::size_t>(s.cell[i])].value;
  else
    for (int i = 0; i < batch.count; ++i)
      values[i] = interpolate(s.cell[i], s.theta_h[i], s.theta_d[i], s.phi_d[i]);
}

void MeasuredBrdf::evaluate(const DirectionBatch& batch, Float4* values) const {
  HalfDifferenceBatch angles;
  angles.count = batch.count;
  half_differences(batch, angles);
  evaluate(angles, values);
  for (int i = 0; i < batch.count; ++i)
    if (!(batch.wi[2][i] > 0 && batch.wo[2][i] > 0))
      values[i] = Float4{};
}

MeasuredBrdf MeasuredBrdf::symmetrised() const {
  MeasuredBrdf result = *this;
  const int half_turn = merl_phi_d_bins;
  for (int row = 0; row < merl_theta_h_bins * merl_theta_d_bins; ++row) {
    for (int i = 0; i < m_phi_d_bins; ++i) {
      const int mirrored = (half_turn - 1 - i + m_phi_d_bins) % m_phi_d_bins;
      const Float4 sum = cell(0, row, i) + cell(0, row, mirrored);
      result.m_cells[static_cast<std::size_t>(index(0, row, i + 1))].value =
          sum[3] > 0 ? sum / sum[3] : Float4{};
    }
  }
  result.pad_rows();
  return result;
}

} // namespace haarlight::brdf
