// Parts of haarview's window: the orbit camera, the resolution controller and watched files.
#include "temporary_folder.h"

#include <view/controls.h>
#include <view/panes.h>

#include <catch2/catch.hpp>

#include <filesystem>
#include <fstream>

using namespace haarlight;
using namespace haarlight::view;

namespace {

renderer::CameraDescription camera(const Vec3& from) {
  renderer::CameraDescription result;
  result.from = from;
  result.to = Vec3(1, 0, 0);
  return result;
}

bool near(const Vec3& a, const Vec3& b) { return (a - b).norm() < 1e-5F; }

void write(const std::string& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
}

} // namespace

TEST_CASE("a camera that did not move, or moved by a full circle, is the same", "[view]") {
  const auto start = camera({3, 1, -2});
  CHECK(near(OrbitCamera(start).camera().from, start.from));
  OrbitCamera orbit(start);
  orbit.orbit(100, 0);
  orbit.orbit(260, 0);
  CHECK(near(orbit.camera().from, start.from));
}

TEST_CASE("a camera orbits to the right and upwards", "[view]") {
  OrbitCamera orbit(camera({1, 0, 2}));
  orbit.orbit(90, 0);
  CHECK(near(orbit.camera().from, {3, 0, 0}));
  orbit.orbit(0, 30);
  CHECK(near(orbit.camera().from, {1 + std::sqrt(3.0F), 1, 0}));
  orbit.orbit(0, 1000);
  CHECK(orbit.camera().from.y() < 2);
  CHECK(orbit.camera().from.y() > 1.999F);
}

TEST_CASE("zoom changes the distance, or the height of an orthographic camera", "[view]") {
  auto start = camera({1, 0, 2});
  OrbitCamera perspective(start);
  perspective.zoom(4);
  CHECK(near(perspective.camera().from, {1, 0, 0.5F}));
  start.projection = renderer::CameraProjection::Orthographic;
  start.height = 3;
  OrbitCamera orthographic(start);
  orthographic.zoom(4);
  CHECK(near(orthographic.camera().from, start.from));
  CHECK(orthographic.camera().height == Approx(0.75));
}

TEST_CASE("resolution is coarse while something moves, then becomes finer", "[view]") {
  ResolutionController resolution(false);
  resolution.update(true, 16 * 60, 1);
  CHECK(resolution.pixel_size() == 4);
  CHECK(resolution.interactive());
  resolution.update(true, 1e9, 1);
  CHECK(resolution.pixel_size() == 8);
  resolution.update(false, 10, 1); // the estimate is of an interactive frame
  CHECK(resolution.pixel_size() == 8);
  for (const int size : {4, 2, 1, 1}) {
    resolution.update(false, 10, 1);
    CHECK(resolution.pixel_size() == size);
  }
  resolution.update(false, 10, 2);
  CHECK(resolution.pixel_size() == 2);
  ResolutionController fixed(true);
  fixed.update(true, 1e9, 4);
  CHECK(fixed.pixel_size() == 1);
}

TEST_CASE("a changed file is reported once, when it no longer changes", "[view]") {
  const TemporaryFolder folder;
  const std::string path = folder.file("file");
  write(path, "one");
  FileWatch watch({path});
  CHECK_FALSE(watch.changed());
  write(path, "another");
  CHECK_FALSE(watch.changed()); // it may still be being written
  CHECK(watch.changed());
  CHECK_FALSE(watch.changed());
  std::filesystem::remove(path);
  CHECK_FALSE(watch.changed());
  CHECK(watch.changed());
}
