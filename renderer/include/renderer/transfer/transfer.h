#pragma once
// Transfer: for each pixel's integral ∫ f_r L v cos dω, the product of all factors but one as a
// tree. When the remaining factor varies, pixels are inner products (the paper's eqs. 14-16 with T1
// stored and T2 new).
//
// All factors share the light's frame, which is the world's rotated by the scene's "rotate". A new
// light is then the same function for every pixel, and visibilities are computed by rays in the
// world; a reflectance is rotated by its pyramid's look-ups, which are made per square anyway,
// whereas rotating the stored light into every pixel's reflection frame would blur it.

#include <renderer/scene/loaded_scene.h>
#include <renderer/visibility/visibility.h>

#include <wavelet/product/projection.h>

#include <string>
#include <vector>

namespace haarlight::renderer {

/// The varying factor, which is left out of the product.
enum class Varying {
  Light,    ///< T = f_r cos · v: the light may be rotated or replaced
  Object,   ///< T = f_r cos · L · v of all other objects: one object may move
  Material, ///< T = L · v: one material may be replaced
  View      ///< T = L · v: the eye may move
};

/// One kind of variation in a scene.
struct Variation {
  Varying varying = Varying::Light;
  int index = -1; ///< of the object or material in the scene's order
};

/// The first hit of a pixel's ray, its normal on the viewer's side.
struct FilmPoint {
  Hit hit; ///< object −1: nothing
  Vec3 wo; ///< unit, towards the viewer, world
};

/// One point per pixel, row 0 first. @param without object that counts as absent; −1: none
std::vector<FilmPoint> film_points(const SceneDescription& scene, int width, int height,
                                   int without = -1);

/// The tolerance of projections for an error of about 2 % in pictures. It is larger for an object,
/// which occludes whole regions, and for a reflectance than for a light.
double default_transfer_tolerance(Varying varying);

/// Builds the trees of pixels; one per thread.
///
/// A pixel that does not vary has a tree without nodes whose mean is the pixel's radiance / 4π:
/// background pixels (with Varying::Light: 0), and pixels of other materials.
class TransferBuilder {
public:
  /// @param scene loaded for SamplerKind::Product; must outlive this, as must `variances`
  /// @param light_variances wavelet::variances_within() of the light's tree
  TransferBuilder(const LoadedScene& scene, const VisibilityTrees& visibility,
                  const Variation& variation, const wavelet::ProjectionOptions& options,
                  const std::vector<float>& light_variances);

  wavelet::Tree make(const FilmPoint& point);

  /// Of the last tree; all 0 where nothing varies.
  const wavelet::ProjectionReport& report() const { return m_report; }

private:
  wavelet::Tree constant(const Rgb& mean) const;
  Rgb background(const FilmPoint& point) const;
  bool varies(const FilmPoint& point) const;

  const LoadedScene& m_scene;
  Variation m_variation;
  wavelet::ProjectionOptions m_options;
  wavelet::ProjectionFactor m_light;
  wavelet::ProductProjector m_projector;
  OccluderTrees m_occluders;
  std::vector<wavelet::ProjectionFactor> m_factors;
  wavelet::ProjectionReport m_report;
};

/// Totals and means over a picture.
struct TransferReport {
  std::uint64_t pixels = 0; ///< that vary
  std::uint64_t nodes = 0;
  double mean_squares = 0; ///< evaluated per varying pixel
  double error = 0; ///< root mean square over varying pixels of the error that the tolerance bounds
  double unresolved = 0; ///< the same of the variation within the finest squares
};

/// The file's header: the scene's name and hash, the varying factor, and the options.
wavelet::SetInfo transfer_info(const SceneDescription& scene, const Variation& variation,
                               const wavelet::ProjectionOptions& options, int width, int height);

/// Builds the trees of all pixels, multithreaded, and passes them to a sink row by row: column x
/// and row y of the set are the pixel's. Memory: a few thousand trees. The caller finishes the
/// sink.
/// @param scene as for TransferBuilder @throws Error(Output) as the sink does
TransferReport build_transfer(const LoadedScene& scene, const Variation& variation,
                              const wavelet::ProjectionOptions& options, int width, int height,
                              wavelet::TreeSink& sink, const wavelet::Progress& progress = {});

/// As on the command line: light, object:NAME or object:NUMBER, material:NAME, view.
std::string variation_text(const SceneDescription& scene, const Variation& variation);

/// Parses variation_text(). @throws std::invalid_argument with the allowed forms
Variation variation_from_text(const SceneDescription& scene, const std::string& text);

} // namespace haarlight::renderer
