#pragma once
// How stored sample values become linear Rec. 709 colours.

#include "decoder.h"
#include "file/colour_space.h"

#include <functional>
#include <optional>

namespace haarlight::probe::reader {

/// From a stored value in [0, 1] (floats may exceed it) to a linear one; empty: it is linear.
using Curve = std::function<double(double)>;

struct Encoding {
  std::array<Curve, 3> curves;           ///< of red, green and blue; grey uses the first
  std::optional<Eigen::Matrix3d> matrix; ///< to Rec. 709; nothing: the primaries are Rec. 709's
  std::string note;                      ///< a sentence on the interpretation of values
};

/// The curve of IEC 61966-2-1 (sRGB).
Encoding srgb_encoding(std::string note);

/// Linear values of Rec. 709.
Encoding linear_encoding(std::string note);

/// A power law: linear = stored^exponent.
Encoding power_encoding(double exponent, std::string note);

/// The encoding of an ICC profile of type matrix/TRC (RGB) or TRC (grey) (ICC.1:2010, annex F).
/// @throws DecodeError for every other profile
Encoding icc_encoding(std::span<const std::byte> profile);

/// Sets the matrix for some primaries.
/// @throws DecodeError if they are degenerate
void set_primaries(Encoding& encoding, const Chromaticities& primaries);

enum class Alpha {
  None,
  Associated,   ///< colours are multiplied by it already: it is dropped
  Unassociated, ///< colours are multiplied by it when they are linear
};

/// Samples as stored, interleaved.
struct SampleLayout {
  int samples = 3;           ///< of a pixel, colours first
  int colours = 3;           ///< 1 or 3
  Alpha alpha = Alpha::None; ///< of the sample after the colours
  bool inverted = false;     ///< 0 is white
};

/// Converts rows of samples.
class RowConverter {
public:
  RowConverter(Encoding encoding, const SampleLayout& layout)
      : m_encoding(std::move(encoding)), m_layout(layout) {}

  /// @param from layout.samples · width values of T: unsigned integers count from 0 to 1
  template <class T>
  void convert(const T* from, int width, float* rgb);

  /// Notes about the interpretation and, once all rows are converted, about alpha.
  std::vector<std::string> notes() const;

private:
  template <class T>
  double linear(T value, std::size_t channel);
  template <class T>
  std::vector<float> make_table(std::size_t channel) const;
  double apply_curve(double value, std::size_t channel) const;

  Encoding m_encoding;
  SampleLayout m_layout;
  std::array<std::vector<float>, 3> m_tables;
  bool m_transparent = false;
};

extern template void RowConverter::convert(const std::uint8_t*, int, float*);
extern template void RowConverter::convert(const std::uint16_t*, int, float*);
extern template void RowConverter::convert(const std::uint32_t*, int, float*);
extern template void RowConverter::convert(const float*, int, float*);

} // namespace haarlight::probe::reader
