#pragma once
// Relighting: pictures as inner products of each pixel's stored transfer with the varying factor.
// <renderer/transfer/transfer.h> builds the trees.

#include <renderer/film/film.h>
#include <renderer/light/light.h>
#include <renderer/transfer/transfer.h>

#include <probe/probe_maps.h>
#include <wavelet/file/tree_set.h>

#include <memory>
#include <span>
#include <string>
#include <vector>

namespace haarlight::renderer {
/// Rotation about +y by yaw, then about +x by pitch, then about +z by roll, fixed world axes,
/// right-handed, degrees. Yaw alone equals the scene's "rotate".
Eigen::Matrix3f rotation_of(const Eigen::Vector3d& yaw_pitch_roll);

/// A light's map under rotations.
class RotatedLight {
public:
  /// @param resolution pixels along a side of the maps, a power of two ≥ 4
  RotatedLight(const Light& light, int resolution);

  /// The light under a rotation applied after the scene's own, as a map in the light's original
  /// frame.
  wavelet::Map map(const Eigen::Matrix3f& turn) const;

private:
  int m_resolution;
  Eigen::Matrix3f m_placed; ///< from the light's frame to the world
  probe::RotatableMap m_level;
};

/// Whether a set is a transfer: by its kind or, in files of versions before 0.2.0, by its
/// provenance.
bool is_transfer(const wavelet::SetInfo& info);

/// A transfer file, mapped or packed.
class Transfer {
public:
  /// @throws Error(Input) if it is malformed or not a transfer file
  explicit Transfer(const std::string& path);

  int width() const { return m_set.info().columns; }   ///< of the film, pixels
  int height() const { return m_set.info().rows; }     ///< likewise
  int resolution() const { return m_set.info().size; } ///< pixels along a side of the trees
  const std::string& path() const { return m_set.path(); }
  const Provenance& provenance() const { return m_set.info().provenance; }
  /// The varying factor in the form of variation_text().
  std::string varying_text() const { return provenance().get("vary"); }
  /// Base name of its scene file.
  std::string scene_name() const { return provenance().get("scene"); }

  /// The varying factor.
  /// @throws Error(Input) if the scene's hash is not the one stored
  Variation variation(const SceneDescription& scene) const;

  /// Trees by pixel, row 0 first.
  std::span<const wavelet::TreeView> trees() const { return m_trees; }

private:
  wavelet::TreeSet m_set;
  std::vector<wavelet::TreeView> m_trees;
};

/// A change of the varying factor. Members that do not apply to it are ignored.
struct Change {
  Eigen::Vector3d rotate = Eigen::Vector3d::Zero(); ///< light: yaw, pitch, roll as in rotation_of()
  Vec3 move = Vec3::Zero(); ///< object or eye: displacement from its position in the scene, world
};

/// Computes pictures from a transfer file under changes of its varying factor: a light that rotates
/// or is replaced, an object that moves with its shadows, a replaced material, or a moved eye.
class Relighter {
public:
  virtual ~Relighter() = default;
  /// Sets pixel colours only: the film's other arrays stay 0.
  virtual Film make(const Change& change) = 0;
};

/// @param transfer, scene must outlive the result
/// @param scene    as stored, except that the varying factor may name other files
/// @throws Error(Input) if those cannot be read
std::unique_ptr<Relighter> make_relighter(const Transfer& transfer, const SceneDescription& scene,
                                          const Variation& variation);

} // namespace haarlight::renderer
