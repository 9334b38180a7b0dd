#include "probe_files.h"

#include <probe/probe_maps.h>
#include <probe/read_probe.h>

#include <wavelet/base/parallel.h>
#include <wavelet/square/sphere_map.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <random>

using namespace haarlight;
using namespace haarlight::probe;
using haarlight::testing::real_probe;

namespace {

Image blank(Mapping mapping, int size) {
  return {mapping == Mapping::LatLong ? 2 * size : size, size};
}

float map_integral(const wavelet::Map& map) {
  return luminance(wavelet::map_mean(map).cast<float>()) * 4 * pi;
}

/// Smooth, different in every direction.
Rgb landscape(const Vec3& w) {
  return Rgb(1.2F + w.x() + 0.1F * w.z(), 1.2F + w.y(), 1.2F + w.z() * w.x()).max(0);
}

Probe landscape_probe(Mapping mapping, int size) {
  Image image = blank(mapping, size);
  const Probe shape(image, mapping);
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x)
      image.set(x, y, landscape(shape.direction(x, y)));
  return {image, mapping};
}

Vec3 pixel_direction(int x, int y, int size) {
  return wavelet::square_to_sphere(Vec2((static_cast<float>(x) + 0.5F) / static_cast<float>(size),
                                        (static_cast<float>(y) + 0.5F) / static_cast<float>(size)));
}

} // namespace

TEST_CASE("Default sizes lose nothing", "[maps]") {
  const auto size_for = [](int width) {
    return default_map_size(Probe(Image(width, width), Mapping::Angular), 1);
  };
  CHECK(size_for(1000) == 2048);
  CHECK(size_for(900) == 2048);
  CHECK(size_for(256) == 1024);
  CHECK(size_for(640) == 2048);
  CHECK(size_for(1500) == 2048);
  CHECK(size_for(4000) == 2048);
  CHECK(default_map_size(Probe(Image(1024, 512), Mapping::LatLong), 1) == 2048);
  CHECK(default_map_size(Probe(Image(1000, 1000), Mapping::Angular), 64) == 128);
}

TEST_CASE("The world map shows the world", "[maps]") {
  for (const Mapping mapping :
       {Mapping::Angular, Mapping::LatLong, Mapping::MirrorBall, Mapping::Octahedral}) {
    const Probe probe = landscape_probe(mapping, 200);
    const wavelet::Map map = world_map(probe, 64, 4);
    float worst = 0;
    for (int y = 0; y < 64; ++y)
      for (int x = 0; x < 64; ++x)
        worst =
            std::max(worst, (map.at(x, y) - landscape(pixel_direction(x, y, 64))).abs().maxCoeff());
    INFO(mapping_name(mapping));
    // The rim of a mirror ball's picture resolves little.
    CHECK(worst < (mapping == Mapping::MirrorBall ? 0.25F : 0.03F));
    CHECK(map_integral(map) == Approx(luminance(probe.integral())).epsilon(1e-3));
  }
}

TEST_CASE("One bright pixel anywhere keeps its energy", "[maps]") {
  std::mt19937 random(47);
  for (const Mapping mapping :
       {Mapping::Angular, Mapping::LatLong, Mapping::MirrorBall, Mapping::Octahedral}) {
    constexpr int size = 48;
    Image image = blank(mapping, size);
    std::vector<std::pair<int, int>> places = {
        {0, size / 2},        {1, size / 2 + 1},    {size / 2, 0}, {size / 2, 1},
        {size / 2, size / 2}, {size - 1, size / 2}, {7, 7},        {3, 0}};
    for (int i = 0; i < 8; ++i)
      places.emplace_back(static_cast<int>(random() % static_cast<unsigned>(image.width)),
                          static_cast<int>(random() % size));
    for (const auto& [x, y] : places) {
      image = blank(mapping, size);
      image.set(x, y, {100, 200, 300});
      const Probe probe(image, mapping);
      const float truth = luminance(probe.integral());
      for (const int map_size : {16, 64}) {
        INFO(mapping_name(mapping) << " " << x << " " << y << " at " << map_size);
        CHECK(map_integral(world_map(probe, map_size, 1)) ==
              Approx(truth).epsilon(0.02).margin(1e-6));
      }
    }
  }
}

TEST_CASE("Small clusters keep their energy", "[maps]") {
  std::mt19937 random(53);
  for (const Mapping mapping : {Mapping::Angular, Mapping::LatLong})
    for (const int extent : {2, 3, 5})
      for (int i = 0; i < 6; ++i) {
        Image image = blank(mapping, 100);
        const int left = 20 + static_cast<int>(random() % 55U);
        const int top =
            (mapping == Mapping::LatLong && i == 0) ? 0 : 20 + static_cast<int>(random() % 55U);
        for (int y = 0; y < extent; ++y)
          for (int x = 0; x < extent; ++x)
            image.set(left + x, top + y, {1, 1, 1});
        const Probe probe(image, mapping);
        INFO(mapping_name(mapping) << " " << extent << " at " << left << " " << top);
        CHECK(map_integral(world_map(probe, 128, 4)) ==
              Approx(luminance(probe.integral())).epsilon(0.02));
      }
}

TEST_CASE("A constant probe gives constant maps", "[maps]") {
  Image image(60, 60);
  for (float& value : image.rgb)
    value = 2;
  const Probe probe(image, Mapping::Angular);
  for (const int orientations : {1, 2, 5}) {
    const ProbeMaps maps(probe, {32, orientations, 4});
    const wavelet::Map map = maps.make(orientations - 1, 0);
    for (const float value : map.rgb)
      REQUIRE(value == Approx(2));
  }
}

namespace {

constexpr Mapping all_mappings[] = {Mapping::Angular, Mapping::LatLong, Mapping::MirrorBall,
                                    Mapping::Octahedral};

/// Mean of the nearest look-up over each map pixel, by `along`² points on a rank-1 lattice each.
wavelet::Map looked_up_map(const Probe& probe, int size, int along) {
  wavelet::Map map(size);
  const int count = along * along;
  parallel_for(static_cast<std::size_t>(size), [&](std::size_t row) {
    const int y = static_cast<int>(row);
    for (int x = 0; x < size; ++x) {
      Rgb sum(0, 0, 0);
      for (int k = 0; k < count; ++k) {
        const double s = (k + 0.5) / count;
        const double t = k * 0.6180339887498949;
        const Vec2 square((static_cast<float>(x + s)) / static_cast<float>(size),
                          (static_cast<float>(y + t - std::floor(t))) / static_cast<float>(size));
        sum += probe.radiance(wavelet::square_to_sphere(square));
      }
      map.set(x, y, sum / static_cast<float>(count));
    }
  });
  return map;
}

float relative_l2(const wavelet::Map& map, const wavelet::Map& reference) {
  double error = 0;
  double norm = 0;
  for (std::size_t i = 0; i < map.rgb.size(); ++i) {
    error += std::pow(double{map.rgb[i]} - reference.rgb[i], 2);
    norm += std::pow(double{reference.rgb[i]}, 2);
  }
  return static_cast<float>(std::sqrt(error / norm));
}

float largest(const std::vector<float>& values) {
  return *std::max_element(values.begin(), values.end());
}

/// A dark noise with pixels of 100 at some places: alone, in pairs, in blocks, at every border.
Image spotted(Mapping mapping, int size) {
  Image image = blank(mapping, size);
  std::mt19937 random(static_cast<unsigned>(size));
  std::uniform_real_distribution<float> uniform(0, 1);
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      const bool bright = uniform(random) < 0.1F || (x >= 3 && x < 6 && y >= 2 && y < 4);
      image.set(x, y, bright ? Rgb(100, 50, 25) : Rgb::Constant(uniform(random)));
    }
  return image;
}

} // namespace

TEST_CASE("Constant probes of any size give constant maps", "[maps]") {
  for (const Mapping mapping : all_mappings)
    for (const int size : {1, 2, 3, 16, 300})
      for (const int map_size : {4, 32}) {
        Image image = blank(mapping, size);
        std::fill(image.rgb.begin(), image.rgb.end(), 2.0F);
        const wavelet::Map map = world_map(Probe(image, mapping), map_size, 1);
        INFO(mapping_name(mapping) << " " << size << " at " << map_size);
        for (const float value : map.rgb)
          REQUIRE(value == Approx(2).epsilon(1e-5));
      }
}

TEST_CASE("Maps agree with the nearest look-up and are nowhere brighter than it", "[maps]") {
  for (const Mapping mapping : all_mappings)
    for (const int size : {1, 2, 8, 31}) {
      const Image image = spotted(mapping, size);
      const Probe probe(image, mapping);
      const wavelet::Map map = world_map(probe, 16, 4);
      const float difference = relative_l2(map, looked_up_map(probe, 16, size < 31 ? 20 : 40));
      INFO(mapping_name(mapping) << " " << size);
      CHECK(difference < 0.012F);
      CHECK(largest(map.rgb) <= largest(image.rgb) * 1.00001F);
      CHECK(map_integral(map) == Approx(luminance(probe.integral())).epsilon(1e-3));
    }
}

TEST_CASE("A bright pixel of a coarse probe fills its own area and no other", "[maps]") {
  for (const Mapping mapping : all_mappings) {
    Image image = blank(mapping, 8);
    image.set(image.width / 2, 2, {100, 100, 100});
    const Probe probe(image, mapping);
    const wavelet::Map map = world_map(probe, 32, 4);
    const wavelet::Map reference = looked_up_map(probe, 32, 16);
    INFO(mapping_name(mapping));
    CHECK(relative_l2(map, reference) < 0.01F);
    CHECK(largest(map.rgb) == Approx(100).epsilon(1e-4));
    for (std::size_t i = 0; i < map.rgb.size(); ++i)
      REQUIRE(map.rgb[i] == Approx(reference.rgb[i]).margin(5));
  }
}

TEST_CASE("Lights of a fine probe are spread by area too", "[maps]") {
  for (const Mapping mapping : all_mappings) {
    Image image = blank(mapping, 320);
    std::mt19937 random(59);
    for (int i = 0; i < 40; ++i)
      image.set(static_cast<int>(random() % static_cast<unsigned>(image.width)),
                static_cast<int>(random() % 320U), {1000, 1000, 1000});
    const Probe probe(image, mapping);
    const wavelet::Map map = world_map(probe, 64, 1);
    INFO(mapping_name(mapping));
    CHECK(relative_l2(map, looked_up_map(probe, 64, 24)) < 0.1F);
    CHECK(largest(map.rgb) <= 1000 * 1.00001F);
    CHECK(map_integral(map) == Approx(luminance(probe.integral())).epsilon(0.002));
  }
}

TEST_CASE("The largest radiances do not overflow", "[maps]") {
  constexpr float most = std::numeric_limits<float>::max();
  Image image = blank(Mapping::LatLong, 200);
  std::fill(image.rgb.begin(), image.rgb.end(), most);
  const wavelet::Map map = world_map(Probe(image, Mapping::LatLong), 16, 4);
  for (const float value : map.rgb)
    REQUIRE(value == Approx(most).epsilon(1e-5));
  for (const float value : rotate_map(make_rotatable(map), {}, 16).rgb)
    REQUIRE(value == Approx(most).epsilon(1e-5));
}

TEST_CASE("Frames of cells", "[maps]") {
  for (int j = 0; j < 8; ++j)
    for (int i = 0; i < 8; ++i) {
      const Frame frame = light_frame(i, j, 8);
      CHECK((frame.n - pixel_direction(i, j, 8)).norm() < 1e-6F);
      CHECK((frame.t.cross(frame.b) - frame.n).norm() < 1e-5F);
      const Vec3 near = (frame.n + 0.2F * frame.t - 0.1F * frame.b).normalized();
      const Frame carried = carried_frame(frame, near);
      CHECK((carried.t.cross(carried.b) - near).norm() < 1e-5F);
      CHECK(carried.t.dot(frame.t) > 0.95F);
      CHECK((carried.to_outer({0, 0, 1}) - near).norm() < 1e-6F);
      // The least rotation leaves the axis across it alone.
      const Vec3 axis = frame.n.cross(near).normalized();
      CHECK((carried.to_outer(frame.to_local(axis)) - axis).norm() < 1e-5F);
    }
}

TEST_CASE("A rotated map shows the world in its cell's frame", "[maps]") {
  const Probe probe = landscape_probe(Mapping::LatLong, 128);
  const ProbeMaps maps(probe, {32, 16, 4});
  REQUIRE(maps.info().columns == 16);
  for (const auto& [i, j] :
       {std::pair(0, 0), std::pair(3, 11), std::pair(8, 7), std::pair(15, 2)}) {
    const wavelet::Map map = maps.make(i, j);
    const Frame frame = light_frame(i, j, 16);
    float worst = 0;
    for (int y = 0; y < 32; ++y)
      for (int x = 0; x < 32; ++x)
        worst = std::max(
            worst,
            (map.at(x, y) - landscape(frame.to_outer(pixel_direction(x, y, 32)))).abs().maxCoeff());
    INFO(i << " " << j);
    CHECK(worst < 0.08F);
  }
}

TEST_CASE("Every rotated map keeps the energy of a small sun", "[maps]") {
  Image image(256, 128);
  for (float& value : image.rgb)
    value = 0.1F;
  image.set(100, 40, {3000, 3000, 3000});
  const Probe probe(image, Mapping::LatLong);
  for (const int size : {16, 64})
    for (const int orientations : {4, 16}) {
      const ProbeMaps maps(probe, {size, orientations, 4});
      double sum = 0;
      float worst = 0;
      const float truth = luminance(*maps.integral(0, 0));
      for (int j = 0; j < orientations; j += orientations / 4)
        for (int i = 0; i < orientations; i += orientations / 4) {
          const float part = map_integral(maps.make(i, j));
          sum += part / 16;
          worst = std::max(worst, std::abs(part / truth - 1));
        }
      INFO(size << " " << orientations << " worst " << worst);
      CHECK(sum == Approx(truth).epsilon(0.002));
      CHECK(worst < 0.003F);
    }
}

namespace {

/// Mean of the nearest look-up over each map pixel, in a frame or over a cell of frames, by `count`
/// points of a lattice of four dimensions.
wavelet::Map looked_up_in(const Probe& probe, int size, int count,
                          const std::function<Frame(const Vec2&)>& frame_at) {
  const auto lattice = [](int k, int coordinate) {
    const double x = 0.25 + k / std::pow(1.1673039782614187, coordinate + 1);
    return static_cast<float>(x - std::floor(x));
  };
  std::vector<Frame> frames;
  for (int k = 0; k < count; ++k)
    frames.push_back(frame_at(Vec2(lattice(k, 2), lattice(k, 3))));
  wavelet::Map map(size);
  parallel_for(static_cast<std::size_t>(size), [&](std::size_t row) {
    const int y = static_cast<int>(row);
    std::vector<Vec3> directions(frames.size());
    std::vector<Rgb> values(frames.size());
    for (int x = 0; x < size; ++x) {
      for (int k = 0; k < count; ++k) {
        const Vec2 place(static_cast<float>(x) + lattice(k, 0),
                         static_cast<float>(y) + lattice(k, 1));
        directions[static_cast<std::size_t>(k)] = frames[static_cast<std::size_t>(k)].to_outer(
            wavelet::square_to_sphere(place / static_cast<float>(size)));
      }
      probe.radiance(directions, values);
      Rgb sum(0, 0, 0);
      for (const Rgb& value : values)
        sum += value;
      map.set(x, y, sum / static_cast<float>(count));
    }
  });
  return map;
}

Frame turned_by(float angle, const Vec3& axis) {
  const Eigen::Matrix3f turn = Eigen::AngleAxisf(angle, axis.normalized()).toRotationMatrix();
  return {turn.col(0), turn.col(1), turn.col(2)};
}

Probe random_probe(std::mt19937& random) {
  const Mapping mapping = all_mappings[random() % 4U];
  const int height = 1 + static_cast<int>(random() % 20U);
  Image image(mapping == Mapping::LatLong ? 1 + static_cast<int>(random() % 20U) : height, height);
  std::exponential_distribution<float> exponential(1);
  for (float& value : image.rgb)
    value = std::pow(exponential(random), 4.0F);
  return {image, mapping};
}

/// Largest radiance of any pixel that shows in a direction.
float brightest(const Probe& probe) {
  float most = 0;
  for (int y = 0; y < probe.height(); ++y)
    for (int x = 0; x < probe.width(); ++x)
      most = std::max(most, probe.pixel(x, y).maxCoeff());
  return most;
}

constexpr float rounding = 2e-5F;

} // namespace

TEST_CASE("Rotated maps are never brighter than the probe, and keep its integral", "[maps]") {
  std::mt19937 random(61);
  std::uniform_real_distribution<float> uniform(-1, 1);
  for (int i = 0; i < 12; ++i) {
    const Probe probe = random_probe(random);
    const wavelet::Map world = world_map(probe, 32, 1);
    const float most = brightest(probe) * (1 + rounding);
    const Vec3 axis(uniform(random), uniform(random), uniform(random));
    const wavelet::Map turned =
        rotate_map(make_rotatable(world), turned_by(4 * uniform(random), axis), 16);
    const ProbeMaps maps(probe, {16, 3, 4});
    const wavelet::Map cell = maps.make(static_cast<int>(random() % 3U), 1);
    INFO(mapping_name(probe.mapping()) << " " << probe.width() << " x " << probe.height());
    CHECK(largest(turned.rgb) <= most);
    CHECK(largest(cell.rgb) <= most);
    CHECK(map_integral(turned) == Approx(map_integral(world)).epsilon(0.005));
    CHECK(map_integral(cell) == Approx(luminance(probe.integral())).epsilon(0.03));
  }
}

TEST_CASE("Two lights side by side are nowhere added together by a rotation", "[maps]") {
  // Each brighter than three times the mean around it.
  wavelet::Map world(32);
  world.set(20, 9, {100, 100, 100});
  world.set(21, 9, {100, 100, 100});
  const RotatableMap level = make_rotatable(world);
  for (int i = 0; i < 20; ++i) {
    const Frame frame = turned_by(0.3F * static_cast<float>(i), Vec3(1, 2, static_cast<float>(i)));
    for (const int size : {8, 32, 64}) {
      const wavelet::Map map = rotate_map(level, frame, size);
      INFO(i << " at " << size);
      REQUIRE(largest(map.rgb) <= 100 * (1 + rounding));
      REQUIRE(map_integral(map) == Approx(map_integral(world)).epsilon(0.005));
    }
  }
}

TEST_CASE("Rotated maps of constant probes are constant", "[maps]") {
  for (const Mapping mapping : all_mappings)
    for (const int size : {1, 2, 16}) {
      Image image = blank(mapping, size);
      std::fill(image.rgb.begin(), image.rgb.end(), 2.0F);
      const Probe probe(image, mapping);
      const RotatableMap level = make_rotatable(world_map(probe, 32, 1));
      INFO(mapping_name(mapping) << " " << size);
      for (const float value : rotate_map(level, turned_by(1, Vec3(1, 2, 3)), 16).rgb)
        REQUIRE(value == Approx(2).epsilon(rounding));
      for (const float value : ProbeMaps(probe, {16, 5, 1}).make(1, 3).rgb)
        REQUIRE(value == Approx(2).epsilon(rounding));
    }
}

TEST_CASE("Rotated maps agree with the nearest look-up", "[maps]") {
  const Frame turn = turned_by(0.7F, Vec3(0.3F, -0.5F, 0.8F));
  for (const Mapping mapping : all_mappings)
    for (const int size : {1, 8}) {
      const Probe probe(spotted(mapping, size), mapping);
      const wavelet::Map turned = rotate_map(make_rotatable(world_map(probe, 64, 4)), turn, 16);
      const wavelet::Map cell = ProbeMaps(probe, {16, 4, 8}).make(2, 1);
      INFO(mapping_name(mapping) << " " << size);
      CHECK(relative_l2(turned, looked_up_in(probe, 16, 400, [&](const Vec2&) { return turn; })) <
            0.04F);
      CHECK(relative_l2(cell, looked_up_in(probe, 16, 600, [&](const Vec2& in_cell) {
                          return carried_frame(
                              light_frame(2, 1, 4),
                              wavelet::square_to_sphere((Vec2(2, 1) + in_cell) / 4));
                        })) < 0.08F);
    }
}

TEST_CASE("Maps do not depend on the number of threads", "[maps]") {
  const Probe probe = landscape_probe(Mapping::Angular, 90);
  const auto make = [&](int threads) {
    const ThreadLimit limit(threads);
    return ProbeMaps(probe, {64, 1, 4}).make(0, 0).rgb;
  };
  CHECK(make(1) == make(2));
}

TEST_CASE("A set describes itself", "[maps]") {
  Provenance source;
  source.set("source", "sky.hdr");
  const Probe probe = landscape_probe(Mapping::Angular, 40);
  const wavelet::SetInfo world = ProbeMaps(probe, {}, source).info();
  CHECK(world.kind == wavelet::SetKind::Light);
  CHECK((world.size == 512 && world.map_count() == 1 && world.world_frame));
  CHECK(world.units == "radiance of the probe");
  CHECK(world.provenance.get("source") == "sky.hdr");
  CHECK(world.provenance.get("mapping") == "angular");
  CHECK(world.provenance.get("supersample") == "4");
  CHECK_FALSE(world.provenance.get("version").empty());
  const wavelet::SetInfo table = ProbeMaps(probe, {0, 3, 2}, source).info();
  CHECK((table.size == 128 && table.columns == 3 && table.rows == 3 && !table.world_frame));
  CHECK(table.frame != world.frame);
}

TEST_CASE("The real probes keep their energy", "[maps][shared-data]") {
  for (const char* name : {"grace_probe.hdr", "studio_small_03_angular_256.hdr"}) {
    const Probe probe = read_probe(real_probe(name)).probe;
    const wavelet::Map map = world_map(probe, 256, 4);
    INFO(name);
    CHECK(map_integral(map) == Approx(luminance(probe.integral())).epsilon(0.003));
  }
}
