#include "encoding.h"

#include <wavelet/base/elementary.h>

#include <cmath>
#include <limits>
#include <type_traits>

namespace haarlight::probe::reader {
namespace {

double srgb_curve(double v) { return v <= 0.04045 ? v / 12.92 : power((v + 0.055) / 1.055, 2.4); }

/// A stored sample from 0 to 1.
template <class T>
double unit_value(T value, bool inverted) {
  double v = value;
  if constexpr (std::is_integral_v<T>)
    v /= std::numeric_limits<T>::max();
  return inverted ? 1 - v : v;
}

} // namespace

Encoding srgb_encoding(std::string note) {
  return {{srgb_curve, srgb_curve, srgb_curve}, std::nullopt, std::move(note)};
}

Encoding linear_encoding(std::string note) { return {{}, std::nullopt, std::move(note)}; }

Encoding power_encoding(double exponent, std::string note) {
  const Curve curve = [exponent](double v) { return power(v, exponent); };
  return {{curve, curve, curve}, std::nullopt, std::move(note)};
}

void set_primaries(Encoding& encoding, const Chromaticities& primaries) {
  encoding.matrix = rec709_from_rgb(primaries);
  if (!encoding.matrix)
    throw Refusal("has primaries that span no colour space");
  if (encoding.matrix->isIdentity())
    encoding.matrix.reset();
}

double RowConverter::apply_curve(double value, std::size_t channel) const {
  const Curve& curve = m_encoding.curves[channel];
  return curve ? curve(value) : value;
}

template <class T>
std::vector<float> RowConverter::make_table(std::size_t channel) const {
  std::vector<float> table(std::size_t{std::numeric_limits<T>::max()} + 1);
  for (std::size_t i = 0; i < table.size(); ++i)
    table[i] =
        static_cast<float>(apply_curve(unit_value(static_cast<T>(i), m_layout.inverted), channel));
  return table;
}

template <class T>
double RowConverter::linear(T value, std::size_t channel) {
  if constexpr (sizeof(T) <= 2) {
    if (m_tables[channel].empty())
      m_tables[channel] = make_table<T>(channel);
    return m_tables[channel][value];
  } else {
    return apply_curve(unit_value(value, m_layout.inverted), channel);
  }
}

template <class T>
void RowConverter::convert(const T* from, int width, float* rgb) {
  for (int x = 0; x < width; ++x, from += m_layout.samples, rgb += 3) {
    Eigen::Vector3d colour = Eigen::Vector3d::Constant(linear(from[0], 0));
    if (m_layout.colours == 3) {
      colour[1] = linear(from[1], 1);
      colour[2] = linear(from[2], 2);
      if (m_encoding.matrix)
        colour = *m_encoding.matrix * colour;
    }
    if (m_layout.alpha == Alpha::Unassociated) {
      const double alpha = unit_value(from[m_layout.colours], false);
      m_transparent = m_transparent || alpha != 1;
      colour *= alpha;
    }
    for (int c = 0; c < 3; ++c)
      rgb[c] = static_cast<float>(colour[c]);
  }
}

std::vector<std::string> RowConverter::notes() const {
  std::vector<std::string> notes;
  if (!m_encoding.note.empty())
    notes.push_back(m_encoding.note);
  if (m_transparent)
    notes.emplace_back("colours were multiplied by the unassociated alpha channel");
  return notes;
}

template void RowConverter::convert(const std::uint8_t*, int, float*);
template void RowConverter::convert(const std::uint16_t*, int, float*);
template void RowConverter::convert(const std::uint32_t*, int, float*);
template void RowConverter::convert(const float*, int, float*);

} // namespace haarlight::probe::reader
