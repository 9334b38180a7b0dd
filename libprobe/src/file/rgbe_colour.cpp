#include "file/rgbe_colour.h"

#include <algorithm>
#include <cmath>

namespace haarlight::probe {
namespace {

constexpr Primaries rec709 = {0.64, 0.33, 0.30, 0.60, 0.15, 0.06, 0.3127, 0.3290};
constexpr Primaries radiance_default = {0.640, 0.330, 0.290, 0.600, 0.150, 0.060, 0.333, 0.333};
constexpr Primaries zeros = {};

/// Headers round to three digits.
bool nearly_equal(const Primaries& a, const Primaries& b) {
  return std::equal(a.begin(), a.end(), b.begin(),
                    [](double u, double v) { return std::abs(u - v) < 0.002; });
}

} // namespace

bool are_rec709(const Primaries& primaries) {
  return nearly_equal(primaries, rec709) || nearly_equal(primaries, radiance_default) ||
         primaries == zeros;
}

std::optional<ColourMatrix> primaries_to_rec709(const Primaries& primaries) {
  const Primaries& p = primaries;
  const auto found = rec709_from_rgb({{p[0], p[1]}, {p[2], p[3]}, {p[4], p[5]}, {p[6], p[7]}});
  if (!found)
    return std::nullopt;
  ColourMatrix rows{};
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c)
      rows[static_cast<std::size_t>(r)][static_cast<std::size_t>(c)] = (*found)(r, c);
  return rows;
}

} // namespace haarlight::probe
