#pragma once
// A surface point on a path: the light it sends back, and where the path goes on.

#include "../samplers/lobe_sampling.h"
#include "emitters.h"

#include <renderer/loaded_scene.h>

#include <span>
#include <vector>

namespace haarlight::renderer {

/// How a path leaves a vertex.
struct Departure {
  Vec3 direction = Vec3::UnitZ(); ///< unit, world
  Rgb weight = Rgb::Zero();       ///< f_r cos / pdf
  float pdf = 0;                  ///< sr⁻¹, of the reflectance's sampling
};

/// Where the random points of a vertex's samples come from; those of different dimensions and keys
/// go together.
struct VertexPoints {
  Points kind = Points::Sobol;
  std::uint32_t key = 0;   ///< of pixel, seed and vertex
  std::uint32_t first = 0; ///< index of the first path

  void fill(std::uint32_t dimension, std::span<Vec2> out) const {
    fill_shuffled_points(kind, hash_words(key, dimension), first, out);
  }
};

/// What a technique's sample counts with where another could have found it: the balance heuristic
/// with one sample of each.
inline float balance(float own, float other) { return own / (own + other); }

/// Turns from point to point, for any number of samples at each; one thread's.
class PathVertex {
public:
  PathVertex(const LoadedScene& scene, const Emitters& emitters)
      : m_scene(scene), m_emitters(emitters) {}

  /// @param hit its normal on the viewer's side
  /// @param wo  unit direction to the viewer, world
  void arrive(const Hit& hit, const Vec3& wo);

  /// Adds to each sum what one sample of the distant light by itself sends back; departures that
  /// escape have the rest.
  void add_light(const VertexPoints& points, std::span<Rgb> sums);

  /// Adds to each sum what one sample of the emitters sends back; departures that meet one have
  /// the rest.
  void add_emitters(const VertexPoints& points, std::span<Rgb> sums);

  /// Draws departures by the reflectance.
  void depart(const VertexPoints& points, std::span<Departure> out);

  /// The share of the distant light seen along a departure that add_light() leaves to it.
  Rgb escaped(const Departure& departure) const;

  /// The share of what `hit`, first along a departure from `from`, emits that add_emitters() leaves
  /// to it.
  Rgb met(const Hit& from, const Departure& departure, const Hit& hit) const;

private:
  void evaluate(std::span<const DirectionSample> samples);
  Rgb emitter_sample(const EmitterDirection& to) const;

  const LoadedScene& m_scene;
  const Emitters& m_emitters;
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
