#pragma once
// Transfer: of each pixel's integral ∫ f_r L v cos dω the product of all factors but one, as a
// tree. While that one is moved about, the picture follows by inner products (the paper's eqs.
// 14-16 with T1 kept and T2 new).
//
// All factors share one frame: the light's own, which is the world's but for the scene's "rotate".
// It is the best one for each kind of variation. A new light or visibility is then the same
// function for every pixel, or found by rays in the world; a new reflectance is turned into it by
// its pyramid's look-ups, which are made per square anyway, while turning the stored light into
// every pixel's reflection frame would blur it.

#include <renderer/scene/loaded_scene.h>
#include <renderer/visibility/visibility.h>

#include <wavelet/product/projection.h>

#include <string>
#include <vector>

namespace haarlight::renderer {

/// The factor that is left out.
enum class Varying {
  Light,    ///< T = f_r cos · v: the light may turn, or be another
  Object,   ///< T = f_r cos · L · v of all other objects: one object may move
  Material, ///< T = L · v: the reflectance of one material may be another
  View      ///< T = L · v: every point may be seen from elsewhere
};

/// One kind of variation in a scene.
struct Variation {
  Varying varying = Varying::Light;
  int index = -1; ///< of the object or material in the scene's order
};

/// What the film's rays meet; hits are turned to the viewer's side.
struct FilmPoint {
  Hit hit; ///< object −1: nothing
  Vec3 wo; ///< unit, towards the viewer, world
};

/// One point for each pixel, row 0 first. @param without object that rays pass through; −1: none
std::vector<FilmPoint> film_points(const SceneDescription& scene, int width, int height,
                                   int without = -1);

/// The tolerance of projections that leaves pictures an error of about 2 %, and often less: what
/// the varying factor is integrated with is coarser for an object, which hides whole regions, and
/// for a reflectance than for a light.
double default_transfer_tolerance(Varying varying);

/// Makes the trees of pixels, one after another; one for each thread.
///
/// A pixel that the variation leaves as it is has a tree without nodes, its mean the pixel's
/// radiance / 4π: where nothing is hit (with Varying::Light: 0), and other materials' pixels.
class TransferMaker {
public:
  /// @param scene loaded for SamplerKind::Product; must outlive this, as must `variances`
  /// @param light_variances wavelet::variances_within() of the light's tree
  TransferMaker(const LoadedScene& scene, const VisibilityTrees& visibility,
                const Variation& variation, const wavelet::ProjectionOptions& options,
                const std::vector<float>& light_variances);

  wavelet::Tree make(const FilmPoint& point);

  /// What the last one left; all 0 where nothing varies.
  const wavelet::ProjectionReport& report() const { return m_report; }

private:
  wavelet::Tree constant(const Rgb& mean) const;
  Rgb background(const FilmPoint& point) const;
  void add_visibilities(const Hit& hit);
  bool varies(const FilmPoint& point) const;

  const LoadedScene& m_scene;
  const VisibilityTrees& m_visibility;
  Variation m_variation;
  wavelet::ProjectionOptions m_options;
  wavelet::ProjectionFactor m_light;
  wavelet::ProductProjector m_projection;
  wavelet::RegionTreeBuilder m_regions;
  std::vector<wavelet::Tree> m_visibilities; ///< of which as many are in use as there are terms
  std::vector<wavelet::ProjectionFactor> m_terms;
  wavelet::ProjectionReport m_report;
};

/// Sums and means over a picture's transfer.
struct TransferReport {
  std::uint64_t pixels = 0; ///< that vary
  std::uint64_t nodes = 0;
  double mean_squares = 0; ///< looked at for one of these pixels
  double error = 0;        ///< root mean square over these of what the tolerance bounds
  double unresolved = 0;   ///< the same of what varies within the finest squares
};

/// What the file says of itself: the scene by name and hash, what varies, and the options.
wavelet::SetInfo transfer_info(const SceneDescription& scene, const Variation& variation,
                               const wavelet::ProjectionOptions& options, int width, int height);

/// Makes the trees of all pixels, from several threads, and gives them to a sink row by row: column
/// x and row y of the set are the pixel's. Memory: a few thousand trees. The caller finishes.
/// @param scene as for TransferMaker @throws Error(Output) as the sink does
TransferReport build_transfer(const LoadedScene& scene, const Variation& variation,
                              const wavelet::ProjectionOptions& options, int width, int height,
                              wavelet::TreeSink& sink, const wavelet::Progress& progress = {});

/// As on the command line: light, object:NAME or object:NUMBER, material:NAME, view.
std::string variation_text(const SceneDescription& scene, const Variation& variation);

/// Reads variation_text() back. @throws std::invalid_argument saying what would be right
Variation variation_from_text(const SceneDescription& scene, const std::string& text);

} // namespace haarlight::renderer
