// Scene files: what is said about wrong ones.

#include "scene_text.h"

#include <random>
#include <vector>

using namespace haarlight;
using namespace haarlight::renderer;

TEST_CASE("a JSON syntax error is reported with byte, line and column", "[scene]") {
  const SceneOnDisk disk(R"({"film": {"width": 256,, "height": 4}})");
  try {
    load_scene(disk.path());
    FAIL("loads");
  } catch (const Error& error) {
    REQUIRE(error.offset());
    CHECK(*error.offset() == 23);
    CHECK(
        std::string(error.what()).find("byte 23: line 1, column 24: invalid JSON: syntax error") !=
        std::string::npos);
  }
  const auto begins = [](const std::string& text, const std::string& begin) {
    CHECK_THAT(complaint(text), Catch::StartsWith(begin));
  };
  begins("", "byte 0: line 1, column 1: invalid JSON: syntax error");
  begins(plain_scene.substr(0, 300), "byte 300: line 5, column 1: invalid JSON: ");
  begins(plain_scene + "}", "byte " + std::to_string(plain_scene.size()) + ": line 7, column 98: ");
  begins("{\"film\": \xFF\xFE\n}", "byte 9: line 1, column 10: invalid JSON: ");
  begins("{\"film\":\n\n  tru}", "byte 15: line 3, column 6: invalid JSON: ");
  begins("{\"film\":\r\n 1e999}", "byte 15: line 2, column 6: invalid JSON: number overflow");
  CHECK(complaint(std::string(100000, '[')) == "nests deeper than 64 levels");
  CHECK(complaint("[]") == "must be an object, is an array");
}

TEST_CASE("files that cannot be scenes are refused", "[scene]") {
  const SceneOnDisk disk(plain_scene);
  CHECK_THROWS_AS(load_scene(disk.folder() + "/missing.json"), Error);
  CHECK_THROWS_AS(load_scene(disk.folder()), Error);
}

TEST_CASE("each mistake is named with its place and the remedy", "[scene]") {
  const struct {
    std::string from;
    std::string to;
    std::string says;
  } mistakes[] = {
      {R"("width": 256)", R"("widht": 256)",
       R"(film: unknown key "widht", the nearest known is "width")"},
      {R"("film")", R"("Film")", R"(unknown key "Film", the nearest known is "film")"},
      {R"("radius": 1)", R"("raduis": 1)",
       R"(objects[0]: unknown key "raduis", the nearest known is "radius")"},
      {R"("normal")", R"("radius")", R"(objects[1]: unknown key "radius")"},
      {R"("brdf")", R"("bdrf")",
       R"(materials["acrylic"]: unknown key "bdrf", the nearest known is "brdf")"},
      {R"("fov": 30)", R"("height": 30)", R"(camera: unknown key "height")"},
      {R"("type": "sphere")", R"("type": "shpere")",
       R"(objects[0].type: unknown shape "shpere", the nearest known is "sphere")"},
      {R"("perspective")", R"("prespective")",
       R"(camera.type: unknown camera "prespective", the nearest known is "perspective")"},
      {R"("material": "floor")", R"("material": "flor")",
       R"(objects[1].material: unknown material "flor", the nearest known is "floor")"},
      {R"("haar": "grace.haar")", R"("mapping": "lat-long")",
       R"(light.mapping: unknown mapping "lat-long", the nearest known is "latlong")"},
      {R"("haar": "grace.haar")", R"("probe": "grace.hdr")",
       R"(duplicate key "probe" in one object)"},
      {R"("width": 256, )", "", R"(film: the key "width" is missing)"},
      {R"(, "material": "floor")", "", R"(objects[1]: the key "material" is missing)"},
      {R"("radius": 1, )", "", R"(objects[0]: the key "radius" is missing)"},
      {R"("width": 256)", R"("width": "256")", "film.width: must be a number, is a string"},
      {R"("width": 256)", R"("width": 2.5)", "film.width: must be a whole number"},
      {R"("width": 256)", R"("width": 0)", "film: a film of 0x128 pixels has no area"},
      {R"("width": 256)", R"("width": 1e9)", "film: a film of 1000000000x128 pixels is too large"},
      {R"("radius": 1)", R"("radius": -1)", "objects[0].radius: must be positive"},
      {R"("radius": 1)", R"("radius": 1e-60)", "objects[0].radius: must be positive"},
      {R"("radius": 1)", R"("radius": 1e30)", "objects[0].radius: must lie within -1e18 and 1e18"},
      {R"("radius": 1)", R"("radius": null)", "objects[0].radius: must be a number, is null"},
      {R"([0, -1, 0])", R"([0, -1])", "objects[1].point: must hold 3 numbers, holds 2 values"},
      {R"([0, -1, 0])", R"([0, true, 0])",
       "objects[1].point[1]: must be a number, is true or false"},
      {R"("normal": [0, 1, 0])", R"("normal": [0, 0, 0])",
       "objects[1].normal: must not be the zero vector"},
      {R"("up": [0, 1, 0])", R"("up": [0, 0, 0])", "camera.up: must not be the zero vector"},
      {R"("up": [0, 1, 0])", R"("up": [0, -1, -12])",
       "camera: up must not be parallel to the view"},
      {R"("to": [0, 0, 0])", R"("to": [0, 0.5, 6])",
       "camera.to: must not be the same point as from"},
      {R"("fov": 30)", R"("fov": 180)", "camera.fov: must lie between 0.001 and 179 degrees"},
      {R"("probe": "grace_probe.hdr", "haar": "grace.haar")", "",
       "light: needs at least one of the keys probe, haar, table"},
      {R"("grace.haar")", R"("")", "light.haar: must not be empty"},
      {R"("grace.haar")", R"("a\u0000b")", "light.haar: must not contain a NUL"},
      {R"("haar": "grace.haar")", R"("rotate": "left")",
       "light.rotate: must be a number, is a string"},
      {R"("haar": "grace.haar")", R"("background": 1)",
       "light.background: must be true or false, is a number"},
      {R"("lambert": [0.5, 0.25, 1])", "",
       R"(materials["floor"]: needs at least one of the keys brdf, haar, table, or lambert)"},
      {R"("lambert": [0.5, 0.25, 1])", R"("lambert": [0.5, 0.25, 1], "brdf": "a")",
       R"(materials["floor"]: lambert stands alone)"},
      {R"([0.5, 0.25, 1])", R"([0.5, 1.25, 1])",
       R"(materials["floor"].lambert: must hold albedos between 0 and 1)"},
      {R"("lambert": [0.5, 0.25, 1])", "",
       R"(materials["floor"]: needs at least one of the keys brdf, haar, table, or lambert, or a )"
       R"(model: ggx, blinn-phong, ward, lafortune, ashikhmin-shirley)"},
      {R"("lambert")", R"("blin-phong")",
       R"(materials["floor"]: unknown key "blin-phong", the nearest known is "blinn-phong")"},
      {R"("lambert": [0.5, 0.25, 1])", R"("ggx": 0.2)",
       R"(materials["floor"].ggx: must be an object, is a number)"},
      {R"("lambert": [0.5, 0.25, 1])", R"("ggx": {"exponent": 2})",
       R"(materials["floor"].ggx: unknown key "exponent")"},
      {R"("lambert": [0.5, 0.25, 1])", R"("ggx": {"roughness": 0})",
       R"(materials["floor"].ggx.roughness: must lie between 0.001 and 1)"},
      {R"("lambert": [0.5, 0.25, 1])", R"("ward": {"roughness": 1.5})",
       R"(materials["floor"].ward.roughness: must lie between 0.001 and 1)"},
      {R"("lambert": [0.5, 0.25, 1])", R"("blinn-phong": {"exponent": -1})",
       R"(materials["floor"].blinn-phong.exponent: must lie between 0.001 and 1000000)"},
      {R"("lambert": [0.5, 0.25, 1])", R"("ashikhmin-shirley": {"specular": [0, 0, 2]})",
       R"(materials["floor"].ashikhmin-shirley.specular: must hold albedos between 0 and 1)"},
      {R"("lambert": [0.5, 0.25, 1])", R"("ward": {"diffuse": 0.5})",
       R"(materials["floor"].ward.diffuse: must be an array, is a number)"},
      {R"("lambert": [0.5, 0.25, 1])", R"("lafortune": {"lobe_xy": 11})",
       R"(materials["floor"].lafortune.lobe_xy: must lie between -10 and 10)"},
      {R"("lambert": [0.5, 0.25, 1])", R"("lafortune": {"lobe_xy": 0, "lobe_z": 0})",
       R"(materials["floor"].lafortune: lobe_xy and lobe_z must not both be zero)"},
      {R"("lambert": [0.5, 0.25, 1])", R"("ggx": {}, "haar": "a")",
       R"(materials["floor"]: a model stands alone, without brdf, haar, table or another model)"},
      {R"("lambert": [0.5, 0.25, 1])", R"("ggx": {}, "ward": {})",
       R"(materials["floor"]: a model stands alone)"},
      {R"("lambert": [0.5, 0.25, 1])", R"("emission": [1, -1, 1])",
       R"(materials["floor"].emission: must hold radiances, none below 0)"},
      {R"("lambert": [0.5, 0.25, 1])", R"("emission": 5)",
       R"(materials["floor"].emission: must be an array, is a number)"},
      {R"("lambert": [0.5, 0.25, 1])",
       R"("lambert": [0, 0, 0], "brdf": "a", "emission": [1, 1, 1])",
       R"(materials["floor"]: lambert stands alone)"}};
  for (const auto& mistake : mistakes) {
    INFO(mistake.to << " instead of " << mistake.from);
    const std::string text = complaint(replaced(plain_scene, mistake.from, mistake.to));
    CHECK_THAT(text, Catch::StartsWith(mistake.says));
  }
}

TEST_CASE("each mistaken shape and transform is named", "[scene]") {
  const std::string box = R"({"type": "box", "min": [-1, -1, -1], "max": [1, 1, 1], "transform": )";
  const struct {
    std::string object;
    std::string says;
  } mistakes[] = {
      {R"({"type": "box", "min": [0, 0, 0], "max": [1, 0, 1])",
       "objects[1].max: must be above min in x, y and z"},
      {R"({"type": "cylinder", "base": [1, 2, 3], "top": [1, 2, 3], "radius": 2)",
       "objects[1].top: must not be the same point as base"},
      {R"({"type": "cone", "base": [1, 2, 3], "apex": [1, 2, 3], "radius": 2)",
       "objects[1].apex: must not be the same point as base"},
      {R"({"type": "torus", "center": [0, 0, 0], "axis": [0, 1, 0], "major_radius": 1,
           "minor_radius": 1)",
       "objects[1].minor_radius: must be below major_radius"},
      {R"({"type": "torus", "center": [0, 0, 0], "axis": [0, 0, 0], "major_radius": 1,
           "minor_radius": 0.5)",
       "objects[1].axis: must not be the zero vector"},
      {box + R"({"scale": 0})", "objects[1].transform.scale: must not be zero"},
      {box + R"([{"scale": 1}, {"scale": [1, 0, 1]}])",
       "objects[1].transform[1].scale: must not be zero"},
      {box + R"([{"scael": 1}])",
       R"(objects[1].transform[0]: unknown key "scael", the nearest known is "scale")"},
      {box + R"({"scale": 1, "translate": [1, 0, 0]})",
       "objects[1].transform: must hold exactly one of"},
      {box + R"({"rotate": {"axis": [0, 0, 0], "angle": 3}})",
       "objects[1].transform.rotate.axis: must not be the zero vector"},
      {box + R"({"rotate": 30})", "objects[1].transform.rotate: must be an array, is a number"},
      {box + R"({"matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 1, 0, 0, 1]})",
       "objects[1].transform.matrix: must end with the row 0, 0, 0, 1"},
      {box + R"({"matrix": [1, 0, 0, 0, 2, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]})",
       "objects[1].transform: cannot be inverted"},
      {box + R"([{"scale": 1e12}, {"scale": 1e12}])", "objects[1].transform: cannot be inverted"},
      {box + R"("left")", "objects[1].transform: must be an array, is a string"}};
  for (const auto& mistake : mistakes) {
    INFO(mistake.object);
    const std::string text = complaint(with_object(mistake.object));
    CHECK_THAT(text, Catch::StartsWith(mistake.says));
  }
}

TEST_CASE("names from the file cannot break the message", "[scene]") {
  const std::string text = complaint(
      replaced(plain_scene, R"("radius")", R"("a\nb\u0007)" + std::string(9000, 'x') + '"'));
  CHECK(text.find(R"(unknown key "a?b?xxx)") != std::string::npos);
  CHECK(text.size() < 400);
}

TEST_CASE("nonsense is refused or read, and nothing else", "[scene]") {
  const SceneOnDisk disk(plain_scene);
  std::mt19937 random(9);
  const std::string alphabet = "{}[]\",:0123456789.eE+-truefalsn \\\n\t\xC3";
  int refused = 0;
  for (int i = 0; i < 1500; ++i) {
    std::string text = plain_scene;
    for (unsigned edits = 1 + random() % 4; edits > 0; --edits) {
      const std::size_t place = random() % text.size();
      if (random() % 3 == 0)
        text.erase(place, 1 + random() % 20);
      else
        text[place] = alphabet[random() % alphabet.size()];
    }
    disk.write(text);
    try {
      load_scene(disk.path());
    } catch (const Error& error) {
      REQUIRE(std::string(error.what()).find('\n') == std::string::npos);
      ++refused;
    }
  }
  CHECK(refused > 500);
}
