// Cameras and the film they look through.

#include <renderer/film/film.h>
#include <renderer/scene/camera.h>

#include <catch2/catch.hpp>

#include <cmath>

using namespace haarlight;
using namespace haarlight::renderer;

namespace {

CameraDescription front_view() {
  CameraDescription camera;
  camera.from = Vec3(0, 0, 5);
  camera.fov = 40;
  return camera;
}

CameraDescription oblique_view() {
  CameraDescription camera;
  camera.from = Vec3(1, 2, 3);
  camera.to = Vec3(-2, 0.5F, -1);
  camera.up = Vec3(0.1F, 1, 0.2F);
  camera.fov = 55;
  camera.height = 3;
  return camera;
}

} // namespace

TEST_CASE("row 0 is up and x runs to the right", "[camera]") {
  const Camera camera(front_view(), 200, 100);
  const Vec3 middle = camera.generate_ray(100, 50).direction;
  CHECK((middle - Vec3(0, 0, -1)).norm() < 1e-6F);
  const Vec3 first = camera.generate_ray(0.5F, 0.5F).direction;
  CHECK(first.x() < 0);
  CHECK(first.y() > 0);
  const Vec3 last = camera.generate_ray(199.5F, 99.5F).direction;
  CHECK(last.x() > 0);
  CHECK(last.y() < 0);
}

TEST_CASE("fov spans the vertical side, pixels are square", "[camera]") {
  const Camera camera(front_view(), 200, 100);
  const auto slope = [&](float x, float y) {
    const Vec3 d = camera.generate_ray(x, y).direction;
    REQUIRE(d.norm() == Approx(1).epsilon(1e-6));
    return Vec2(d.x() / -d.z(), d.y() / -d.z());
  };
  const double half = std::tan(20 * M_PI / 180);
  CHECK(slope(100, 0).y() == Approx(half).epsilon(1e-5));
  CHECK(slope(100, 100).y() == Approx(-half).epsilon(1e-5));
  CHECK(slope(200, 50).x() == Approx(2 * half).epsilon(1e-5));
  CHECK(slope(37, 50).x() - slope(36, 50).x() == Approx(half / 50).epsilon(1e-4));
  CHECK(slope(100, 36).y() - slope(100, 37).y() == Approx(half / 50).epsilon(1e-4));
}

TEST_CASE("a perspective ray passes through what projects to its film point", "[camera]") {
  const CameraDescription description = oblique_view();
  const Camera camera(description, 320, 180);
  const Eigen::Vector3d forward = (description.to - description.from).cast<double>().normalized();
  const Eigen::Vector3d right = forward.cross(description.up.cast<double>()).normalized();
  const Eigen::Vector3d up = right.cross(forward);
  for (int i = 0; i < 200; ++i) {
    const Ray ray = camera.generate_ray(static_cast<float>(i) * 1.6F, 180 - static_cast<float>(i));
    CHECK(ray.origin == description.from);
    const Eigen::Vector3d d = ray.direction.cast<double>();
    const double focal = 90 / std::tan(27.5 * M_PI / 180);
    REQUIRE(160 + focal * d.dot(right) / d.dot(forward) == Approx(1.6 * i).margin(1e-3));
    REQUIRE(90 - focal * d.dot(up) / d.dot(forward) == Approx(180 - i).margin(1e-3));
  }
}

TEST_CASE("orthographic rays are parallel and span the height", "[camera]") {
  CameraDescription description = oblique_view();
  description.projection = CameraProjection::Orthographic;
  const Camera camera(description, 320, 180);
  const Vec3 forward = (description.to - description.from).normalized();
  const Ray top = camera.generate_ray(160, 0);
  const Ray bottom = camera.generate_ray(160, 180);
  const Ray left = camera.generate_ray(0, 90);
  const Ray right = camera.generate_ray(320, 90);
  CHECK((top.direction - forward).norm() < 1e-6F);
  CHECK((left.direction - forward).norm() < 1e-6F);
  CHECK((top.origin - bottom.origin).norm() == Approx(3).epsilon(1e-5));
  CHECK((right.origin - left.origin).norm() == Approx(3 * 320.0 / 180).epsilon(1e-5));
  CHECK((top.origin - bottom.origin).dot(description.up) > 0);
  CHECK((camera.generate_ray(160, 90).origin - description.from).norm() < 1e-6F);
  CHECK(std::abs((left.origin - description.from).dot(forward)) < 1e-5F);
}

TEST_CASE("films hold what is put in and refuse impossible sizes", "[film]") {
  Film film(3, 2);
  CHECK(film.count() == 6);
  CHECK(film.rgb.size() == 18);
  CHECK(film.index(2, 1) == 5);
  film.set_color(5, Rgb(1, 2, 3));
  film.set_normal(4, Vec3(0, 1, 0));
  CHECK((film.color(5) == Rgb(1, 2, 3)).all());
  CHECK(film.rgb[17] == 3);
  CHECK(film.normal[13] == 1);
  CHECK(validate_film_size(8192, 8192).empty());
  CHECK(validate_film_size(8192, 8193).find("too large") != std::string::npos);
  CHECK(validate_film_size(1LL << 40, 1LL << 40).find("too large") != std::string::npos);
  CHECK(validate_film_size(0, 5).find("no area") != std::string::npos);
  CHECK(validate_film_size(5, -1).find("no area") != std::string::npos);
}
