#pragma once
// The scene's distant light: its true radiance, and the trees that stand for it when sampling.

#include <renderer/material/tree_table.h>
#include <renderer/scene/scene.h>

#include <probe/light_distribution.h>
#include <probe/probe.h>
#include <wavelet/tree/map_set.h>

#include <optional>
#include <span>

namespace haarlight::renderer {

/// All directions are in the light's own frame: the probe's axes, turned against the world about +y
/// by the scene's "rotate". With a tree alone, the tree is the truth.
class Light {
public:
  /// @throws Error(Input) as the files' readers do
  Light(const LightDescription& description, probe::Lookup lookup);

  /// Radiance from a unit direction.
  Rgb radiance(const Vec3& w) const;
  /// The same from many, as many as `out`.
  void radiance(std::span<const Vec3> directions, std::span<Rgb> out) const;

  /// Makes what samplers use, if not there yet: the world-frame tree; the distribution to draw
  /// from.
  void require_tree();
  void require_distribution();

  /// After require_tree().
  const wavelet::TreeView& tree() const { return m_map->tree(0, 0); }

  /// The picture it is looked up in, in the light's own frame, if there is one.
  const probe::Probe* probe() const { return m_probe ? &*m_probe : nullptr; }

  /// The paper's table of rotated maps, if the scene names one.
  const TreeTable* rotated_table() const { return m_rotated ? &*m_rotated : nullptr; }

  /// Draws directions in proportion to radiance, one for each point of [0, 1)², as many as `out`;
  /// after require_distribution(). Densities in sr⁻¹.
  void sample(std::span<const Vec2> points, std::span<probe::LightSample> out) const;
  float pdf(const Vec3& w) const;

  /// The probe's pixels as a distribution, after require_distribution(); null if there is no probe.
  const probe::LightDistribution* distribution() const {
    return m_distribution ? &*m_distribution : nullptr;
  }

  /// Average radiance over the squares of a map, in the light's own frame, of the probe or else of
  /// the tree; never negative. No finer than the tree, or much finer than the probe.
  /// @param most  pixels along a side at most, a power of two ≥ 4
  /// @param least pixels along a side of a probe's map at least, a power of two ≥ 4
  wavelet::Map map(int most, int least = 4) const;

  Vec3 to_world(const Vec3& w) const { return m_turned ? Vec3(m_to_world * w) : w; }
  Vec3 to_light(const Vec3& w) const { return m_turned ? Vec3(m_to_world.transpose() * w) : w; }

  /// A sentence on how the probe was read, or empty.
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
