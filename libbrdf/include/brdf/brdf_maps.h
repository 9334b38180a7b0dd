#pragma once
// A measured BRDF resampled into a set of maps, the input of products.
//
// Frame of a map: z = the mirror direction ω_r; the normal is n = (sin θ_r cos φ, sin θ_r sin φ,
// cos θ_r); ω_o is the mirror image of z about n. The pixel at local direction ω holds f_r(ω_o, ω)
// · max(0, n·ω) in sr⁻¹ (or f_r alone), averaged over the pixel and over the entry's cell: column c
// covers θ_r ∈ [c, c + 1)·(π/2)/theta and row r the rolls φ ∈ [r, r + 1)·2π/roll. With roll = 1 the
// row is φ = 0 exactly: other rolls are rotations of the frame at run time.
//
// Pixels are sampled more finely where the table's bins of θ_h are finer, so that no lobe is
// missed.

#include <brdf/measured_brdf.h>

#include <wavelet/tree/map_set.h>

#include <mutex>
#include <optional>
#include <string>
#include <vector>

namespace haarlight::brdf {

struct BrdfMapOptions {
  int size = 0;   ///< pixels along a side, a power of two; 0 = 512 for roll 1, else 128
  int theta = 64; ///< cells of θ_r
  int roll = 1;   ///< cells of φ over the full circle; 1 = the set without rolls
  /// Which rows to store. Unset: Rotations if roll > 1 is a multiple of 4, else None. Mirrors needs
  /// a multiple of 8, and averages the table with its bilateral mirror image.
  std::optional<wavelet::Fold> fold;
  int supersample = 2; ///< samples along a pixel's side at least; rounded up to a power of two ≥ 2
  bool cosine = true;  ///< include max(0, n·ω)
};

/// Checks options. @return what is wrong, as a message for users; nothing if they are valid
std::optional<std::string> validate(const BrdfMapOptions& options);

class BrdfMaps : public wavelet::MapSource {
public:
  /// @param options that validate() accepts
  explicit BrdfMaps(MeasuredBrdf brdf, const BrdfMapOptions& options = {});

  const wavelet::SetInfo& info() const override { return m_info; }

  /// Safe to call from several threads; one call uses one.
  wavelet::Map make(int column, int row) const override;

  /// The directional albedo (or ∫ f_r dω without the cosine) averaged over the cell of θ_r, by
  /// quadrature over half vectors (see <brdf/brdf_properties.h>).
  std::optional<Rgb> integral(int column, int row) const override;

private:
  struct Albedo {
    std::once_flag once;
    Rgb value;
  };

  void describe(const BrdfMapOptions& options);
  wavelet::Map sample(int column, int row) const;

  MeasuredBrdf m_brdf;
  BrdfMapOptions m_options;
  wavelet::SetInfo m_info;
  mutable std::vector<Albedo> m_albedos; ///< by column
};

} // namespace haarlight::brdf
