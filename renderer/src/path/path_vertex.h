#pragma once
// A surface point on a path: the light it sends back, and where the path goes on.

#include "path/emitters.h"
#include "samplers/lobe_sampling.h"

#include <renderer/scene/loaded_scene.h>

#include <optional>
#include <span>
#include <vector>

namespace haarlight::renderer {

/// How a path leaves a vertex.
struct BsdfSample {
  Vec3 direction = Vec3::UnitZ(); ///< unit, world
  Rgb weight = Rgb::Zero();       ///< f_r cos / pdf
  float pdf = 0;                  ///< sr⁻¹, of the reflectance's sampling
};

/// The point sets of a vertex's samples.
struct VertexPoints {
  Points kind = Points::Sobol;
  std::uint32_t key = 0;   ///< of pixel, seed and vertex
  std::uint32_t first = 0; ///< index of the first path

  /// @param each points for each path, side by side
  void fill(std::uint32_t dimension, int each, std::span<Vec2> out) const {
    fill_points(kind, hash_words(key, dimension), first * static_cast<std::uint32_t>(each), out);
  }
};

/// Samples that a path takes at a vertex.
struct VertexCounts {
  int lights = 1;             ///< of the distant light and of the emitters, each
  int bsdf_samples = 1;       ///< by the reflectance
  bool shares_distant = true; ///< whether bsdf_samples that escape count for the distant light; if
                              ///< not, it is left to others alone
};

/// What a technique counts with where another could have found the same: the balance heuristic.
/// @param own,other numbers of samples times density
inline float balance(float own, float other) { return own / (own + other); }

/// What a bsdf_sample comes upon.
struct PathStep {
  Rgb light = Rgb::Zero(); ///< its share of the light straight from there
  std::optional<Hit> hit;  ///< the surface, its normal on this side; nothing if it escapes
};

/// Turns from point to point, for any number of paths at each; one thread's.
class PathVertex {
public:
  PathVertex(const LoadedScene& scene, const Emitters& emitters)
      : m_scene(scene), m_emitters(emitters) {}

  /// @param hit its normal on the viewer's side
  /// @param wo  unit direction to the viewer, world
  void set_hit(const Hit& hit, const Vec3& wo, const VertexCounts& counts = {});

  /// Adds to each path's sum what its samples of the distant light by itself send back;
  /// bsdf_samples that escape have the rest.
  void add_light(const VertexPoints& points, std::span<Rgb> sums);

  /// Adds to each path's sum what its samples of the emitters send back; bsdf_samples that meet one
  /// have the rest.
  void add_emitters(const VertexPoints& points, std::span<Rgb> sums);

  /// Draws bsdf_samples by the reflectance, those of one path side by side.
  void sample_bsdf(const VertexPoints& points, std::span<BsdfSample> out);

  /// Looks along one of the bsdf_samples. Its light is to be averaged over those of a path.
  PathStep look(const BsdfSample& bsdf_sample) const;

private:
  void evaluate(std::span<const DirectionSample> samples);
  Rgb emitter_sample(const EmitterDirection& to) const;
  Rgb escaped(const BsdfSample& bsdf_sample) const;
  Rgb met(const BsdfSample& bsdf_sample, const Hit& hit) const;
  float lights() const { return static_cast<float>(m_counts.lights); }
  float bsdf_samples() const { return static_cast<float>(m_counts.bsdf_samples); }

  const LoadedScene& m_scene;
  const Emitters& m_emitters;
  VertexCounts m_counts;
  Hit m_hit;
  ShadingPoint m_point;
  const Material* m_material = nullptr;
  Lobe m_lobe;
  std::vector<Vec2> m_points;
  std::vector<Vec2> m_choices;
  std::vector<probe::LightSample> m_lights;
  std::vector<DirectionSample> m_samples;
  std::vector<Vec3> m_directions;
  std::vector<Rgb> m_reflected;
  std::vector<Rgb> m_radiance;
};

} // namespace haarlight::renderer
