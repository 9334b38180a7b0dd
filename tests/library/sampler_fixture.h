#pragma once
// Small scenes for samplers, and what is true of them by quadrature.

#include "temporary_folder.h"

#include <renderer/samplers/sampler.h>
#include <renderer/scene/loaded_scene.h>

#include <brdf/analytic.h>
#include <brdf/brdf_maps.h>
#include <brdf/tabulate.h>
#include <probe/probe_maps.h>
#include <probe/read_probe.h>
#include <probe/rgbe.h>
#include <probe/synth.h>
#include <wavelet/square/sphere_map.h>
#include <wavelet/transform/compress.h>

#include <functional>
#include <vector>

namespace haarlight::renderer {

inline void write_haar(const std::string& path, const wavelet::MapSource& source) {
  OutputFile file(path);
  wavelet::CompressOptions options;
  options.threshold.tolerance = default_tolerance(source.info(), options.threshold.criterion);
  wavelet::compress_set(source, options, file);
  file.commit();
}

/// Two glossy materials and two probes, small, with trees and tables, written once.
class Fixture {
public:
  Fixture() {
    material("rough", 0.35);
    material("glossy", 0.12);
    probe("studio", probe::SceneKind::Studio);
    probe("spheres", probe::SceneKind::Spheres);
  }

  SceneDescription scene(const std::string& material, const std::string& probe) const {
    SceneDescription scene;
    scene.path = "test";
    scene.light.probe = m_folder.file(probe + ".hdr");
    scene.light.haar = m_folder.file(probe + ".haar");
    scene.light.table = m_folder.file(probe + "-table.haar");
    MaterialDescription m;
    m.name = material;
    m.brdf = m_folder.file(material + ".binary");
    m.haar = m_folder.file(material + ".haar");
    m.table = m_folder.file(material + "-table.haar");
    scene.materials.push_back(m);
    scene.objects.push_back({Sphere{}, {}, 0});
    return scene;
  }

private:
  void material(const std::string& name, double roughness) {
    brdf::Ggx ggx;
    ggx.roughness = roughness;
    const std::string file = m_folder.file(name + ".binary");
    brdf::write_merl(file, brdf::tabulate(ggx));
    const brdf::MeasuredBrdf measured(file);
    brdf::BrdfMapOptions options;
    options.size = 128;
    write_haar(m_folder.file(name + ".haar"), brdf::BrdfMaps(measured, options));
    options.size = 32;
    options.theta = 16;
    options.roll = 16;
    write_haar(m_folder.file(name + "-table.haar"), brdf::BrdfMaps(measured, options));
  }

  void probe(const std::string& name, probe::SceneKind kind) {
    const std::string file = m_folder.file(name + ".hdr");
    probe::write_rgbe(file, probe::draw_angular(*probe::make_scene(kind), 64));
    const probe::LoadedProbe loaded = probe::read_probe(file, probe::Mapping::Angular);
    probe::MapOptions options;
    write_haar(m_folder.file(name + ".haar"), probe::ProbeMaps(loaded.probe, options));
    options.size = 32;
    options.orientations = 8;
    write_haar(m_folder.file(name + "-table.haar"), probe::ProbeMaps(loaded.probe, options));
  }

  TemporaryFolder m_folder;
};

inline const Fixture& fixture() {
  static const Fixture f;
  return f;
}

inline std::vector<ShadingPoint> shading_points() {
  std::vector<ShadingPoint> points;
  const Vec3 normals[3] = {Vec3::UnitY(), Vec3(0.6F, 0, 0.8F), Vec3(-0.48F, -0.64F, -0.6F)};
  for (const Vec3& n : normals)
    for (const float tilt : {0.3F, 2.5F})
      points.push_back(shading_point(n, (n + tilt * frame_about(n).b).normalized()));
  return points;
}

/// Calls visit(direction, solid angle) for taps × taps points in every pixel of the probe.
inline void for_each_point(const probe::Probe& probe, int taps,
                           const std::function<void(const Vec3&, double)>& visit) {
  const int side = probe.width() * taps;
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) {
      const Vec2 uv((static_cast<float>(x) + 0.5F) / static_cast<float>(side),
                    (static_cast<float>(y) + 0.5F) / static_cast<float>(side));
      if (probe::in_map(probe.mapping(), uv))
        visit(probe::image_to_direction(probe.mapping(), uv),
              static_cast<double>(probe::solid_angle_density(probe.mapping(), uv)) /
                  (static_cast<double>(side) * side));
    }
}

inline probe::Probe probe_of(const SceneDescription& description) {
  return probe::read_probe(description.light.probe, probe::Mapping::Angular).probe;
}

/// f L cos at a direction, luminance.
inline double integrand(const LoadedScene& scene, const ShadingPoint& point, const Vec3& w) {
  return static_cast<double>(
      luminance(scene.materials()[0].evaluate(point, w) * scene.light().radiance(w)));
}

/// ∫ f L cos dω by brute force over the probe's pixels.
inline double quadrature(const LoadedScene& scene, const ShadingPoint& point,
                         const probe::Probe& probe) {
  double sum = 0;
  for_each_point(probe, 4,
                 [&](const Vec3& w, double omega) { sum += omega * integrand(scene, point, w); });
  return sum;
}

} // namespace haarlight::renderer
