#pragma once
// Pictures from stored transfer: inner products of each pixel's tree with the one factor that
// varies. <renderer/transfer/transfer.h> makes the trees.

#include <renderer/film/film.h>
#include <renderer/transfer/transfer.h>

#include <wavelet/file/tree_set.h>

#include <memory>
#include <span>
#include <string>
#include <vector>

namespace haarlight::renderer {

/// Whether a set is a transfer: by its kind or, in files made before version 0.2.0, by its provenance.
bool is_transfer(const wavelet::SetInfo& info);

/// A transfer file in memory, of either form.
class Transfer {
public:
  /// @throws Error(Input) if it is broken, or holds no transfer
  explicit Transfer(const std::string& path);

  int width() const { return m_set.info().columns; }   ///< of the film, pixels
  int height() const { return m_set.info().rows; }     ///< likewise
  int resolution() const { return m_set.info().size; } ///< pixels along a side of the trees
  const std::string& path() const { return m_set.path(); }
  const Provenance& provenance() const { return m_set.info().provenance; }
  /// What varies, as on the command line of the program that built it.
  std::string varying_text() const { return provenance().get("vary"); }
  /// Base name of the scene it was made of.
  std::string scene_name() const { return provenance().get("scene"); }

  /// What varies in the scene it was made of.
  /// @throws Error(Input) if this is another scene, by its hash
  Variation variation(const SceneDescription& scene) const;

  /// Trees by pixel, row 0 first.
  std::span<const wavelet::TreeView> trees() const { return m_trees; }

private:
  wavelet::TreeSet m_set;
  std::vector<wavelet::TreeView> m_trees;
};

/// What the varying factor is changed to. Members that do not concern it are left alone.
struct Change {
  Eigen::Vector3d rotate = Eigen::Vector3d::Zero(); ///< light: yaw, pitch, roll as in turn_of()
  Vec3 move = Vec3::Zero(); ///< object: from its place in the scene, world; view: the eye likewise
};

/// Makes one picture after another of a transfer; see the functions below for which.
class Relighter {
public:
  virtual ~Relighter() = default;
  /// Pixels alone: the film's other arrays stay 0. The same for any number of threads.
  virtual Film make(const Change& change) = 0;
};

/// @param transfer, scene must outlive the result
/// @param scene    the transfer's own but for the varying factor, which may name other files
/// @throws Error(Input) if that cannot be read
std::unique_ptr<Relighter> make_relighter(const Transfer& transfer, const SceneDescription& scene,
                                          const Variation& variation);

/// The light turns, or is another: inner products with its coefficients. Background pixels show it
/// itself.
std::unique_ptr<Relighter> light_relighter(const Transfer& transfer, const SceneDescription& scene);

/// One object moves and its shadows with it: of each tree what the object hides is left out, found
/// for a sphere by descending where the edge of its circle goes, and for other shapes by the inner
/// product with its visibility. The object itself is drawn where it comes to stand, lit by the
/// scene's light as far as its neighbours let it through.
std::unique_ptr<Relighter> object_relighter(const Transfer& transfer, const SceneDescription& scene,
                                            const Variation& variation);

/// One material is another, or all points are seen from another eye: products of the trees with
/// reflectances that are looked up square by square. The points stay those of the transfer's film,
/// so that what moves with the eye are highlights; points that turn their back to it are black.
std::unique_ptr<Relighter> reflectance_relighter(const Transfer& transfer,
                                                 const SceneDescription& scene,
                                                 const Variation& variation);

} // namespace haarlight::renderer
