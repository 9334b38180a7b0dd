#include "encoding.h"

#include <wavelet/base/elementary.h>

#include <algorithm>
#include <limits>
#include <string_view>
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
    throw DecodeError("has primaries that span no colour space");
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

// ICC profiles (ICC.1:2010) of three primaries and curves, or of one grey curve.

namespace {

[[noreturn]] void reject_profile() {
  throw DecodeError("has an ICC profile that is damaged or has neither primaries nor a grey curve; "
                    "convert the image to sRGB or to linear Rec. 709");
}

/// Big-endian values of a profile or of a tag in it.
class ProfileBytes {
public:
  explicit ProfileBytes(std::span<const std::byte> bytes) : m_bytes(bytes) {}

  bool empty() const { return m_bytes.empty(); }
  ProfileBytes part(std::size_t offset, std::size_t count) const {
    need(offset, count);
    return ProfileBytes(m_bytes.subspan(offset, count));
  }
  std::string_view text(std::size_t offset) const {
    need(offset, 4);
    return {reinterpret_cast<const char*>(m_bytes.data()) + offset, 4};
  }
  std::uint32_t u16(std::size_t offset) const {
    need(offset, 2);
    return std::to_integer<std::uint32_t>(m_bytes[offset]) << 8 |
           std::to_integer<std::uint32_t>(m_bytes[offset + 1]);
  }
  std::uint32_t u32(std::size_t offset) const { return u16(offset) << 16 | u16(offset + 2); }
  /// An s15Fixed16Number.
  double fixed(std::size_t offset) const {
    return static_cast<std::int32_t>(u32(offset)) / 65536.0;
  }

private:
  void need(std::size_t offset, std::size_t count) const {
    if (offset > m_bytes.size() || count > m_bytes.size() - offset)
      reject_profile();
  }

  std::span<const std::byte> m_bytes;
};

/// A tag's data; empty if the profile lacks it.
ProfileBytes find_tag(const ProfileBytes& profile, std::string_view signature) {
  constexpr std::uint32_t most_tags = 256;
  const std::uint32_t count = std::min(profile.u32(128), most_tags);
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::size_t entry = 132 + 12 * std::size_t{i};
    if (profile.text(entry) == signature)
      return profile.part(profile.u32(entry + 4), profile.u32(entry + 8));
  }
  return ProfileBytes({});
}

Curve gamma_curve(double exponent) {
  if (!(exponent > 0))
    reject_profile();
  if (exponent == 1)
    return {};
  return [exponent](double v) { return power(v, exponent); };
}

/// curveType: nothing = identity, one value = a gamma, else a table over [0, 1].
Curve read_curve_table(const ProfileBytes& tag) {
  const std::uint32_t count = tag.u32(8);
  if (count == 0)
    return {};
  if (count == 1)
    return gamma_curve(tag.u16(12) / 256.0);
  if (count > 65536)
    reject_profile();
  std::vector<double> table(count);
  for (std::size_t i = 0; i < count; ++i)
    table[i] = tag.u16(12 + 2 * i) / 65535.0;
  return [table = std::move(table)](double v) {
    const double position = std::clamp(v, 0.0, 1.0) * static_cast<double>(table.size() - 1);
    const auto i = std::min(static_cast<std::size_t>(position), table.size() - 2);
    const double t = position - static_cast<double>(i);
    return (1 - t) * table[i] + t * table[i + 1];
  };
}

/// parametricCurveType: (a v + b)^g + e from d on, c v + f below.
Curve read_parametric_curve(const ProfileBytes& tag) {
  constexpr std::size_t parameter_counts[] = {1, 3, 4, 5, 7};
  const std::uint32_t type = tag.u16(8);
  if (type > 4)
    reject_profile();
  double p[7] = {1, 1, 0, 0, 0, 0, 0}; // g a b c d e f
  for (std::size_t i = 0; i < parameter_counts[type]; ++i)
    p[i] = tag.fixed(12 + 4 * i);
  auto [g, a, b, c, d, e, f] = p;
  if (type == 0)
    return gamma_curve(g);
  if (type == 1 || type == 2) { // a constant below the zero of a v + b
    if (a == 0)
      reject_profile();
    const double offset = type == 2 ? c : 0;
    d = -b / a;
    c = 0;
    e = offset;
    f = offset;
  }
  return [g = g, a = a, b = b, c = c, d = d, e = e, f = f](double v) {
    return v >= d ? power(a * v + b, g) + e : c * v + f;
  };
}

Curve read_curve(const ProfileBytes& tag) {
  if (tag.text(0) == "curv")
    return read_curve_table(tag);
  if (tag.text(0) == "para")
    return read_parametric_curve(tag);
  reject_profile();
}

Encoding read_grey(const ProfileBytes& profile) {
  const ProfileBytes tag = find_tag(profile, "kTRC");
  if (tag.empty())
    reject_profile();
  const Curve curve = read_curve(tag);
  return {{curve, curve, curve}, std::nullopt, {}};
}

/// Profiles round the matrix of Rec. 709, adapted to D50, in several ways.
constexpr double matrix_rounding = 2e-3;

Encoding read_rgb(const ProfileBytes& profile) {
  Encoding encoding;
  Eigen::Matrix3d to_connection_space;
  for (int c = 0; c < 3; ++c) {
    const std::string name(1, "rgb"[c]);
    const ProfileBytes curve = find_tag(profile, name + "TRC");
    const ProfileBytes primary = find_tag(profile, name + "XYZ");
    if (curve.empty() || primary.empty())
      reject_profile();
    encoding.curves[static_cast<std::size_t>(c)] = read_curve(curve);
    for (int i = 0; i < 3; ++i)
      to_connection_space(i, c) = primary.fixed(8 + 4 * static_cast<std::size_t>(i));
  }
  const Eigen::Matrix3d matrix = rec709_from_adapted_xyz(icc_white()) * to_connection_space;
  if ((matrix - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() > matrix_rounding)
    encoding.matrix = matrix;
  return encoding;
}

} // namespace

Encoding icc_encoding(std::span<const std::byte> profile_bytes) {
  const ProfileBytes profile(profile_bytes);
  if (profile.text(36) != "acsp" || profile.text(20) != "XYZ ")
    reject_profile();
  const bool grey = profile.text(16) == "GRAY";
  if (!grey && profile.text(16) != "RGB ")
    reject_profile();
  Encoding encoding = grey ? read_grey(profile) : read_rgb(profile);
  encoding.note = "values were converted to linear Rec. 709 by the embedded ICC profile";
  return encoding;
}

} // namespace haarlight::probe::reader
