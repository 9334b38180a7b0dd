#include "sampler_fixture.h"

#include <renderer/film/render.h>
#include <renderer/transfer/relight.h>

#include <wavelet/base/error.h>
#include <wavelet/base/parallel.h>
#include <wavelet/file/input_file.h>

#include <catch2/catch.hpp>

#include <stdexcept>

using namespace haarlight;
using namespace haarlight::renderer;

namespace {

constexpr int side = 16;

/// A glossy sphere and a small matt one over a matt floor.
SceneDescription small_scene() {
  SceneDescription scene = fixture().scene("rough", "studio");
  scene.hash = "0123456789abcdef";
  scene.camera.from = Vec3(0, 2, 6);
  scene.camera.fov = 40;
  scene.objects[0].shape = Sphere{Vec3(-0.7F, 0, 0), 1};
  MaterialDescription grey;
  grey.name = "grey";
  grey.lambert = Rgb(0.5F, 0.4F, 0.3F);
  scene.materials.push_back(grey);
  scene.objects.push_back({Sphere{Vec3(1, -0.4F, 0.5F), 0.6F}, {}, 1});
  scene.objects.push_back({Plane{Vec3(0, -1, 0), Vec3::UnitY()}, {}, 1});
  scene.object_names = {"", "ball"};
  return scene;
}

Film rendered(const SceneDescription& description) {
  RenderOptions options;
  options.spp = 256;
  const LoadedScene scene(description, {}, options.sampler, false);
  return render(scene, options, side, side).film;
}

/// Root of the sum of squared differences over that of squares.
double difference(const Film& a, const Film& b) {
  double sum = 0;
  double whole = 0;
  for (std::size_t i = 0; i < a.rgb.size(); ++i) {
    sum += std::pow(static_cast<double>(a.rgb[i]) - static_cast<double>(b.rgb[i]), 2);
    whole += std::pow(static_cast<double>(b.rgb[i]), 2);
  }
  return std::sqrt(sum / whole);
}

TransferReport build(const SceneDescription& description, const std::string& vary,
                     const std::string& path, double tolerance) {
  const LoadedScene scene(description, {}, SamplerKind::Product, false);
  const Variation variation = variation_from_text(description, vary);
  wavelet::ProjectionOptions options;
  options.levels = 6;
  options.tolerance = tolerance;
  OutputFile file(path);
  wavelet::TreeSetWriter writer(file, transfer_info(description, variation, options, side, side), 3,
                                options.coefficients);
  const TransferReport report = build_transfer(scene, variation, options, side, side, writer);
  writer.finish();
  file.commit();
  return report;
}

/// A scene with its transfer, and pictures of that.
class Relit {
public:
  Relit(SceneDescription description, const std::string& vary, double tolerance)
      : m_scene(std::move(description)) {
    build(m_scene, vary, m_folder.file("t.haar"), tolerance);
    m_transfer.emplace(m_folder.file("t.haar"));
  }

  const SceneDescription& scene() const { return m_scene; }
  Film make(const Change& change) { return make_in(m_scene, change); }
  Film make_in(const SceneDescription& scene, const Change& change) {
    return make_relighter(*m_transfer, scene, m_transfer->variation(m_scene))->make(change);
  }

private:
  TemporaryFolder m_folder;
  SceneDescription m_scene;
  std::optional<Transfer> m_transfer;
};

std::string bytes_of(const std::string& path) {
  const InputFile file(path);
  return hash_text(file.bytes());
}

} // namespace

TEST_CASE("a light that varies: its own place, another turn, another light") {
  Relit relit(small_scene(), "light", 0.05);
  CHECK(difference(relit.make({}), rendered(relit.scene())) < 0.02);
  SceneDescription turned = relit.scene();
  turned.light.rotate = 70;
  const Film truth = rendered(turned);
  Change change;
  change.rotate[0] = 70;
  CHECK(difference(relit.make(change), truth) < 0.02);
  CHECK(difference(relit.make({}), truth) > 0.1);
  SceneDescription other = relit.scene();
  other.light = fixture().scene("rough", "spheres").light;
  CHECK(difference(relit.make_in(other, {}), rendered(other)) < 0.02);
}

TEST_CASE("transfer files say what they are in the header; older ones in the provenance") {
  const TemporaryFolder folder;
  const std::string path = folder.file("t.haar");
  const Variation variation = variation_from_text(small_scene(), "light");
  wavelet::SetInfo info = transfer_info(small_scene(), variation, {}, 1, 1);
  CHECK(info.kind == wavelet::SetKind::Transfer);
  const auto write = [&] {
    OutputFile file(path);
    wavelet::TreeSetWriter writer(file, info, 3, wavelet::CoefficientType::Half);
    wavelet::Tree tree;
    tree.levels = wavelet::ProjectionOptions().levels;
    tree.level_begin.assign(static_cast<std::size_t>(tree.levels) + 1, 0);
    writer.add(tree);
    writer.finish();
    file.commit();
  };
  write();
  CHECK(Transfer(path).width() == 1);
  info.kind = wavelet::SetKind::Generic;
  write();
  CHECK_THROWS_AS(Transfer(path), Error);
  info.provenance.set("transfer", "1");
  write();
  CHECK(Transfer(path).width() == 1);
}

TEST_CASE("a light turns on top of the scene's own turn, about any axis") {
  SceneDescription scene = small_scene();
  scene.light.rotate = 30;
  Relit relit(scene, "light", 0.05);
  scene.light.rotate = 75;
  Change change;
  change.rotate[0] = 45;
  CHECK(difference(relit.make(change), rendered(scene)) < 0.02);
  change.rotate = Eigen::Vector3d(0, 180, 180); // the same as half a turn about +y
  scene.light.rotate = 210;
  CHECK(difference(relit.make(change), rendered(scene)) < 0.02);
}

TEST_CASE("an object that moves takes its shadow and its own picture along") {
  Relit relit(small_scene(), "object:ball", 0.3);
  CHECK(difference(relit.make({}), rendered(relit.scene())) < 0.03);
  Change change;
  change.move = Vec3(-1.4F, 0.3F, 1);
  SceneDescription moved = relit.scene();
  std::get<Sphere>(moved.objects[1].shape).center += change.move;
  const Film truth = rendered(moved);
  CHECK(difference(relit.make(change), truth) < 0.03);
  CHECK(difference(relit.make({}), truth) > 0.1);
}

TEST_CASE("an object that is no sphere moves, in a light that is turned") {
  SceneDescription scene = small_scene();
  scene.light.rotate = 120;
  scene.objects[1].shape = Box{Vec3(0.5F, -1, 0), Vec3(1.5F, 0.2F, 1)};
  Relit relit(scene, "object:1", 0.3);
  Change change;
  change.move = Vec3(-0.3F, 0.4F, 0.8F);
  scene.objects[1].transform.offset += change.move.cast<double>();
  CHECK(difference(relit.make(change), rendered(scene)) < 0.04);
}

TEST_CASE("a material that varies, and leaves all others as they are") {
  Relit relit(small_scene(), "material:rough", 0.2);
  CHECK(difference(relit.make({}), rendered(relit.scene())) < 0.03);
  SceneDescription other = relit.scene();
  other.materials[0] = fixture().scene("glossy", "studio").materials[0];
  other.materials[0].name = "rough";
  const Film truth = rendered(other);
  CHECK(difference(relit.make_in(other, {}), truth) < 0.03);
  CHECK(difference(relit.make({}), truth) > 0.01);
}

TEST_CASE("a view that varies starts as the picture, and moves highlights") {
  Relit relit(small_scene(), "view", 0.2);
  const Film start = relit.make({});
  CHECK(difference(start, rendered(relit.scene())) < 0.03);
  Change change;
  change.move = Vec3(3, 0, 0);
  CHECK(difference(relit.make(change), start) > 0.01);
  change.move = Vec3(0, 0, -20); // behind: the spheres turn their backs
  const Film behind = relit.make(change);
  CHECK((behind.color(behind.index(5, 7)) == 0).all());
}

TEST_CASE("a light keeps its energy under rotation, and its map without") {
  const SceneDescription scene = small_scene();
  const Light light(scene.light, SourceLookups().probe);
  const RotatedLight turned(light, 32);
  const wavelet::Map map = light.map(32);
  const double mean = wavelet::map_mean(map).mean();
  for (const double angle : {0.0, 33.0, 170.0}) {
    const wavelet::Map made = turned.map(rotation_of(Eigen::Vector3d(angle, -angle, 2 * angle)));
    CHECK(wavelet::map_mean(made).mean() == Approx(mean).epsilon(0.005));
  }
  const wavelet::Map still = turned.map(rotation_of(Eigen::Vector3d::Zero()));
  double error = 0;
  for (std::size_t i = 0; i < map.rgb.size(); ++i)
    error += std::abs(static_cast<double>(still.rgb[i] - map.rgb[i]));
  CHECK(error < 0.1 * 3 * mean * 32 * 32);
}

TEST_CASE("a transfer's bytes depend on the scene and the options alone") {
  const TemporaryFolder folder;
  const SceneDescription scene = small_scene();
  {
    const ThreadLimit one(1);
    build(scene, "light", folder.file("one.haar"), 0.2);
  }
  build(scene, "light", folder.file("many.haar"), 0.2);
  CHECK(bytes_of(folder.file("one.haar")) == bytes_of(folder.file("many.haar")));
}

TEST_CASE("tolerance is kept, and costs bytes") {
  const TemporaryFolder folder;
  const TransferReport fine = build(small_scene(), "light", folder.file("fine.haar"), 0.1);
  const TransferReport coarse = build(small_scene(), "light", folder.file("coarse.haar"), 0.3);
  CHECK(fine.error <= 0.1);
  CHECK(fine.error > 0.05);
  CHECK(coarse.error <= 0.3);
  CHECK(coarse.nodes < fine.nodes / 2);
}

TEST_CASE("the varying factor is named as on the command line") {
  const SceneDescription scene = small_scene();
  for (const char* text : {"light", "view", "object:1", "material:grey"})
    CHECK(variation_text(scene, variation_from_text(scene, text)) == text);
  CHECK(variation_text(scene, variation_from_text(scene, "object:ball")) == "object:1");
  for (const char* text : {"", "lights", "object:", "object:3", "object:bal", "material:gray"})
    CHECK_THROWS_AS(variation_from_text(scene, text), std::invalid_argument);
}

TEST_CASE("a transfer belongs to its scene; other sets are refused") {
  const TemporaryFolder folder;
  SceneDescription scene = small_scene();
  build(scene, "light", folder.file("t.haar"), 0.3);
  const Transfer transfer(folder.file("t.haar"));
  CHECK(transfer.variation(scene).varying == Varying::Light);
  scene.hash = "another";
  CHECK_THROWS_AS(transfer.variation(scene), Error);
  CHECK_THROWS_AS(Transfer(scene.light.haar), Error);
}
