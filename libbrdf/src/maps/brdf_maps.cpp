#include <brdf/brdf_maps.h>

#include "maps/map_kernel.h"

#include <brdf/directional_albedo.h>

#include <cassert>
#include <numbers>

namespace haarlight::brdf {
namespace {

using wavelet::Fold;
using wavelet::Map;

constexpr int largest_size = 8192;

Fold fold_of(const BrdfMapOptions& options) {
  if (options.fold)
    return *options.fold;
  return options.roll > 1 && options.roll % 4 == 0 ? Fold::Rotations : Fold::None;
}

/// Defaults filled in.
BrdfMapOptions complete(BrdfMapOptions options) {
  if (options.size == 0)
    options.size = options.roll == 1 ? 512 : 128;
  options.fold = fold_of(options);
  return options;
}

int stored_rows(const BrdfMapOptions& options) {
  const int parts = *options.fold == Fold::Mirrors ? 8 : *options.fold == Fold::Rotations ? 4 : 1;
  return options.roll / parts;
}

const char* fold_name(Fold fold) {
  return fold == Fold::Mirrors ? "mirrors" : fold == Fold::Rotations ? "rotations" : "none";
}

/// The map of roll φ + π/2 from that of roll φ: ω turns by 90° about z, from +x to +y.
Map quarter_turn(const Map& map) {
  Map turned(map.size);
  for (int y = 0; y < map.size; ++y)
    for (int x = 0; x < map.size; ++x)
      turned.set(map.size - 1 - y, x, map.at(x, y));
  return turned;
}

const char* const frame_convention =
    "z = mirror direction of omega_o about the normal n; n = (sin theta_r cos phi, sin theta_r sin "
    "phi, "
    "cos theta_r); column c covers theta_r in [c, c+1) * (pi/2) / columns; row r covers phi in "
    "[r, r+1) * 2 pi / rolls, or is phi = 0 if there is one roll";

} // namespace

std::optional<std::string> problem_of(const BrdfMapOptions& options) {
  const BrdfMapOptions o = complete(options);
  if (o.size < 2 || o.size > largest_size || (o.size & (o.size - 1)) != 0)
    return "map size must be a power of two from 2 to " + std::to_string(largest_size);
  if (o.theta < 1 || o.roll < 1 || o.supersample < 1)
    return "theta, roll and supersample must be at least 1";
  if (*o.fold == Fold::Rotations && o.roll % 4 != 0)
    return "folding by rotations needs a multiple of 4 rolls";
  if (*o.fold == Fold::Mirrors && o.roll % 8 != 0)
    return "folding by mirrors needs a multiple of 8 rolls";
  return std::nullopt;
}

BrdfMaps::BrdfMaps(MeasuredBrdf brdf, const BrdfMapOptions& options)
    : m_brdf(std::move(brdf)), m_options(complete(options)),
      m_albedos(static_cast<std::size_t>(options.theta)) {
  assert(!problem_of(options));
  describe(m_options);
  if (*m_options.fold == Fold::Mirrors)
    m_brdf = m_brdf.symmetrised();
}

void BrdfMaps::describe(const BrdfMapOptions& options) {
  m_info.kind = wavelet::SetKind::Brdf;
  m_info.size = options.size;
  m_info.columns = options.theta;
  m_info.rows = stored_rows(options);
  m_info.rolls = options.roll;
  m_info.fold = *options.fold;
  m_info.cosine = options.cosine;
  m_info.frame = frame_convention;
  m_info.units = "sr^-1";
  Provenance& provenance = m_info.provenance;
  provenance.set("source", m_brdf.name());
  provenance.set("source_hash", m_brdf.hash());
  provenance.set("lookup", lookup_name(m_brdf.lookup()));
  provenance.set("fold", fold_name(*options.fold));
  provenance.set("supersample", std::to_string(options.supersample));
  provenance.set("version", version_text());
}

Map BrdfMaps::sample(int column, int row) const {
  const double theta_step = std::numbers::pi / 2 / m_options.theta;
  const double phi_step = 2 * std::numbers::pi / m_options.roll;
  const bool rolls = m_options.roll > 1;
  const ReflectionCell cell{column * theta_step, (column + 1) * theta_step,
                            rolls ? row * phi_step : 0, rolls ? (row + 1) * phi_step : 0};
  return MapKernel(m_brdf, cell, m_options.supersample, m_options.cosine).make(m_options.size);
}

Map BrdfMaps::make(int column, int row) const {
  assert(column >= 0 && column < m_info.columns && row >= 0 && row < m_info.rows);
  const int rolls = m_options.roll;
  const int quarter = rolls % 4 == 0 ? rolls / 4 : rolls;
  Map map = sample(column, row % quarter);
  for (int turn = row / quarter; turn > 0; --turn)
    map = quarter_turn(map);
  return map;
}

std::optional<Rgb> BrdfMaps::integral(int column, int /*row*/) const {
  Albedo& albedo = m_albedos[static_cast<std::size_t>(column)];
  std::call_once(albedo.once, [&] {
    const double step = std::numbers::pi / 2 / m_options.theta;
    albedo.value = directional_albedo(m_brdf, column * step, (column + 1) * step, m_options.cosine);
  });
  return albedo.value;
}

} // namespace haarlight::brdf
