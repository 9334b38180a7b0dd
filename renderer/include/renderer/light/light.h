#pragma once
// The scene's distant light: its radiance, and the trees that samplers use for it.

#include <renderer/material/tree_table.h>
#include <renderer/scene/scene.h>

#include <probe/light_distribution.h>
#include <probe/probe.h>
#include <wavelet/tree/map_set.h>

#include <optional>
#include <span>

namespace haarlight::renderer {

/// All directions are in the light's own frame: the probe's axes, rotated against the world about
/// +y by the scene's "rotate". Without a probe the tree defines the radiance.
class Light {
public:
  /// @throws Error(Input) as the files' readers do
  Light(const LightDescription& description, probe::Lookup lookup);

  /// Radiance from a unit direction.
  Rgb radiance(const Vec3& w) const;
  /// The same for out.size() directions.
  void radiance(std::span<const Vec3> directions, std::span<Rgb> out) const;

  /// Creates data that samplers use, if missing: the world-frame tree; the sampling distribution.
  void require_tree();
  void require_distribution();

  /// Requires require_tree().
  const wavelet::TreeView& tree() const { return m_map->tree(0, 0); }

  /// The probe, in the light's own frame, if there is one.
  const probe::Probe* probe() const { return m_probe ? &*m_probe : nullptr; }

  /// The paper's table of rotated maps, if the scene has one.
  const TreeTable* rotated_table() const { return m_rotated ? &*m_rotated : nullptr; }

  /// Samples directions in proportion to luminance, one per point of [0, 1)². Densities in sr⁻¹.
  /// Requires require_distribution().
  void sample(std::span<const Vec2> points, std::span<probe::LightSample> out) const;
  float pdf(const Vec3& w) const;

  /// The distribution of the probe's pixels; null without a probe. Requires require_distribution().
  const probe::LightDistribution* distribution() const {
    return m_distribution ? &*m_distribution : nullptr;
  }

  /// A map of average radiance, ≥ 0, in the light's own frame, of the probe or else of the tree; at
  /// most as fine as the tree, or about as fine as the probe.
  /// @param most  maximum pixels along a side, a power of two ≥ 4
  /// @param least minimum pixels along a side of a probe's map, a power of two ≥ 4
  wavelet::Map map(int most, int least = 4) const;

  Vec3 to_world(const Vec3& w) const { return m_turned ? Vec3(m_to_world * w) : w; }
  Vec3 to_light(const Vec3& w) const { return m_turned ? Vec3(m_to_world.transpose() * w) : w; }

  /// How the probe was read, for reports; may be empty.
  const std::string& note() const { return m_note; }

private:
  void place(double degrees);

  bool m_turned = false;
  Eigen::Matrix3f m_to_world = Eigen::Matrix3f::Identity();
  std::string m_note;
  std::optional<probe::Probe> m_probe;
  std::optional<probe::LightDistribution> m_distribution;
  std::optional<TreeTable> m_map;
  std::optional<TreeTable> m_rotated;
  Provenance m_source;
};

} // namespace haarlight::renderer
