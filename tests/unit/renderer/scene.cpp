// Scene files: what they say.

#include "scene_text.h"

using namespace haarlight;
using namespace haarlight::renderer;

TEST_CASE("a scene has the values of its file", "[scene]") {
  const SceneOnDisk disk(plain_scene);
  const SceneDescription scene = load_scene(disk.path());
  CHECK(scene.width == 256);
  CHECK(scene.height == 128);
  CHECK(scene.hash.size() == 16);
  CHECK(scene.camera.projection == CameraProjection::Perspective);
  CHECK(scene.camera.from == Vec3(0, 0.5F, 6));
  CHECK(scene.camera.fov == 30);
  CHECK(scene.light.probe == disk.folder() + "/grace_probe.hdr");
  CHECK(scene.light.haar == disk.folder() + "/grace.haar");
  CHECK(scene.light.table.empty());
  CHECK(scene.light.mapping == "auto");
  CHECK(scene.light.background);
  REQUIRE(scene.materials.size() == 2);
  CHECK(scene.materials[0].name == "acrylic");
  CHECK(scene.materials[0].brdf == disk.folder() + "/violet-acrylic.binary");
  CHECK_FALSE(scene.materials[0].lambert);
  CHECK((*scene.materials[1].lambert == Rgb(0.5F, 0.25F, 1)).all());
  REQUIRE(scene.objects.size() == 2);
  CHECK(std::get<Sphere>(scene.objects[0].shape).radius == 1);
  CHECK(scene.objects[0].material == 0);
  CHECK(std::get<Plane>(scene.objects[1].shape).point == Vec3(0, -1, 0));
  CHECK(scene.objects[1].material == 1);
}

TEST_CASE("file names count from the scene's folder", "[scene]") {
  const SceneOnDisk disk(replaced(plain_scene, "grace_probe.hdr", "/data/grace_probe.hdr"));
  CHECK(load_scene(disk.path()).light.probe == "/data/grace_probe.hdr");
  const auto before = std::filesystem::current_path();
  std::filesystem::current_path(disk.folder());
  const SceneDescription scene = load_scene("scene.json");
  std::filesystem::current_path(before);
  CHECK(scene.light.haar == "grace.haar");
}

TEST_CASE("the light's and the camera's other keys", "[scene]") {
  const SceneDescription scene = load(replaced(
      replaced(plain_scene, R"("haar": "grace.haar")",
               R"("table": "/t.haar", "mapping": "latlong", "rotate": -30, "background": false, )"
               R"("layer": "beauty", "part": "1")"),
      R"("type": "perspective", "from": [0, 0.5, 6], "to": [0, 0, 0], "up": [0, 1, 0], "fov": 30)",
      R"("type": "orthographic", "from": [0, 0.5, 6], "to": [0, 0, 0], "height": 2.2)"));
  CHECK(scene.light.table == "/t.haar");
  CHECK(scene.light.mapping == "latlong");
  CHECK(scene.light.layer == "beauty");
  CHECK(scene.light.part == "1");
  CHECK(scene.light.rotate == -30);
  CHECK_FALSE(scene.light.background);
  CHECK(scene.camera.projection == CameraProjection::Orthographic);
  CHECK(scene.camera.height == Approx(2.2));
  CHECK(scene.camera.up == Vec3::UnitY());
}

TEST_CASE("any material may be emissive, also one that does not reflect", "[scene]") {
  const std::string floor = R"({"lambert": [0.5, 0.25, 1]})";
  const SceneDescription both =
      load(replaced(plain_scene, floor, R"({"lambert": [0.5, 0.25, 1], "emission": [1, 0, 2e3]})"));
  CHECK((both.materials[0].emission == 0).all());
  CHECK((both.materials[1].emission == Rgb(1, 0, 2e3F)).all());
  CHECK(both.materials[1].lambert);
  const SceneDescription alone = load(replaced(plain_scene, floor, R"({"emission": [3, 3, 3]})"));
  CHECK((alone.materials[1].emission == 3).all());
  CHECK_FALSE(alone.materials[1].lambert);
}

TEST_CASE("every shape is read", "[scene]") {
  const auto disk =
      object(R"({"type": "disk", "center": [1, 2, 3], "normal": [0, 0, 2], "radius": 4)");
  CHECK(std::get<Disk>(disk.shape).radius == 4);
  CHECK(std::get<Disk>(disk.shape).normal == Vec3(0, 0, 2));
  const auto box = object(R"({"type": "box", "min": [1, 2, 3], "max": [4, 5, 6])");
  CHECK(std::get<Box>(box.shape).high == Vec3(4, 5, 6));
  const auto cylinder =
      object(R"({"type": "cylinder", "base": [1, 2, 3], "top": [4, 5, 6], "radius": 2)");
  CHECK(std::get<Cylinder>(cylinder.shape).top == Vec3(4, 5, 6));
  const auto cone = object(R"({"type": "cone", "base": [1, 2, 3], "apex": [4, 5, 6], "radius": 2)");
  CHECK(std::get<Cone>(cone.shape).apex == Vec3(4, 5, 6));
  const auto torus = object(R"({"type": "torus", "center": [1, 2, 3], "axis": [0, 1, 0],
                                "major_radius": 2, "minor_radius": 0.5)");
  CHECK(std::get<Torus>(torus.shape).major_radius == 2);
  CHECK(std::get<Torus>(torus.shape).minor_radius == 0.5F);
}

TEST_CASE("transforms are read step by step", "[scene]") {
  const std::string box = R"({"type": "box", "min": [-1, -1, -1], "max": [1, 1, 1], "transform": )";
  const auto apply = [&](const std::string& steps) {
    return object(box + steps).transform.point({1, 2, 3});
  };
  const auto near = [](const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
    return (a - b).norm() < 1e-12;
  };
  CHECK(near(apply(R"({"translate": [1, 0, 0]})"), {2, 2, 3}));
  CHECK(near(apply(R"({"scale": 2})"), {2, 4, 6}));
  CHECK(near(apply(R"([{"scale": [1, -1, 2]}, {"translate": [1, 1, 1]}])"), {2, -1, 7}));
  CHECK(near(apply(R"({"rotate": {"axis": [0, 0, 5], "angle": 90}})"), {-2, 1, 3}));
  CHECK(near(apply(R"({"rotate": [90, 0, 90]})"), {3, 1, 2}));
  CHECK(near(apply(R"({"matrix": [1, 0, 0, 4, 0, 0, 1, 5, 0, 1, 0, 6, 0, 0, 0, 1]})"), {5, 8, 8}));
  CHECK(near(apply("[]"), {1, 2, 3}));
}

TEST_CASE("an empty stage is a scene", "[scene]") {
  CHECK(load(R"({"film": {"width": 1, "height": 1}, "light": {"haar": "a.haar"}, "materials": {},
    "camera": {"type": "perspective", "from": [0, 0, 1], "to": [0, 0, 0], "fov": 30},
    "objects": []})")
            .objects.empty());
}

TEST_CASE("analytic models are materials", "[scene]") {
  const auto model = [](const std::string& text) {
    return *load(replaced(plain_scene, R"("lambert": [0.5, 0.25, 1])", text)).materials[1].model;
  };
  const auto ggx = std::get<brdf::Ggx>(
      model(R"("ggx": {"diffuse": [0.1, 0.2, 0.3], "specular": [0, 0.5, 1], "roughness": 0.001})"));
  CHECK((ggx.diffuse == Rgb(0.1F, 0.2F, 0.3F)).all());
  CHECK((ggx.specular == Rgb(0, 0.5F, 1)).all());
  CHECK(ggx.roughness == 0.001);
  CHECK(std::get<brdf::BlinnPhong>(model(R"("blinn-phong": {"exponent": 7})")).exponent == 7);
  CHECK(std::get<brdf::Ward>(model(R"("ward": {"roughness": 1})")).roughness == 1);
  CHECK(std::get<brdf::AshikhminShirley>(model(R"("ashikhmin-shirley": {"exponent": 1e6})"))
            .exponent == 1e6);
  const auto lafortune =
      std::get<brdf::Lafortune>(model(R"("lafortune": {"lobe_xy": 0.5, "lobe_z": -2})"));
  CHECK(lafortune.c_xy == 0.5);
  CHECK(lafortune.c_z == -2);
  CHECK(lafortune.exponent == brdf::Lafortune().exponent);
  CHECK_FALSE(load(plain_scene).materials[1].model);
}
