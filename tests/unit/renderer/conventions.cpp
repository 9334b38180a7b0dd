// renderer/CONVENTIONS.md works one pixel by hand. Here its numbers are computed by formulas of
// their own, which use nothing of the libraries, and compared with the page and with a rendering.

#include "temporary_folder.h"

#include <renderer/film/render.h>

#include <brdf/measured_brdf.h>
#include <brdf/merl_file.h>
#include <probe/rgbe.h>

#include <catch2/catch.hpp>

#include <array>
#include <fstream>
#include <map>
#include <random>
#include <sstream>

using namespace haarlight;

namespace {

using V = std::array<double, 3>;
using Numbers = std::map<std::string, std::vector<double>>;

constexpr double half_turn = 3.14159265358979323846;

V add(V a, V b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }
V times(double s, V a) { return {s * a[0], s * a[1], s * a[2]}; }
double dot(V a, V b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
V norm(V a) { return times(1 / std::sqrt(dot(a, a)), a); }
V cross(V a, V b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
std::vector<double> list(V a) { return {a.begin(), a.end()}; }

/// Up to n and ω_o.
void trace_camera(Numbers& page, V& n, V& wo) {
  const V from = {1, 0.5, 4};
  const V f = norm(times(-1, from));
  const V r = norm(cross(f, {0, 1, 0}));
  const V u = cross(r, f);
  const double p = 2 * std::tan(35 * half_turn / 360) / 6;
  const double x = p * (5 + 0.5 - 4);
  const double y = p * (3 - 2 - 0.5);
  const V d = norm(add(f, add(times(x, r), times(y, u))));
  const double b = dot(from, d);
  const double t = -b - std::sqrt(b * b - dot(from, from) + 1);
  n = add(from, times(t, d));
  wo = times(-1, d);
  page.insert({{"F", list(f)}, {"R", list(r)}, {"U", list(u)}, {"p", {p}}, {"X", {x}}, {"Y", {y}}});
  page.insert({{"d", list(d)}, {"t", {t}}, {"n", list(n)}, {"ω_o", list(wo)}});
}

/// From the probe's pixel to ω_i and Ω.
V find_light(Numbers& page) {
  const double a = 2 * (216 + 0.5) / 512 - 1;
  const double b = 1 - 2 * (92 + 0.5) / 512;
  const double r = std::sqrt(a * a + b * b);
  const double s = std::sin(half_turn * r) / r;
  const V wp = {a * s, b * s, -std::cos(half_turn * r)};
  const double cosine = std::cos(half_turn / 6);
  const double sine = std::sin(half_turn / 6);
  const V wi = {cosine * wp[0] + sine * wp[2], wp[1], -sine * wp[0] + cosine * wp[2]};
  page.insert({{"a", {a}}, {"b", {b}}, {"r", {r}}, {"ω_p", list(wp)}, {"ω_i", list(wi)}});
  page["Ω"] = {4 * half_turn * s / (512.0 * 512.0)};
  return wi;
}

struct Angles {
  V h, e;
  double theta_h, theta_d, phi_d;
  V position() const {
    return {90 * std::sqrt(theta_h / (half_turn / 2)), 90 * theta_d / (half_turn / 2),
            180 * (phi_d < 0 ? phi_d + half_turn : phi_d) / half_turn};
  }
};

Angles angles_of(V i, V o) {
  Angles result;
  const V h = add(i, o);
  const V e = add(i, times(-1, o));
  const double length = std::sqrt(dot(h, h));
  result.h = h;
  result.e = e;
  result.theta_h = std::atan2(std::hypot(h[0], h[1]), h[2]);
  result.theta_d = std::atan2(std::sqrt(dot(e, e)), length);
  result.phi_d = std::atan2(h[0] * e[1] - h[1] * e[0], -length * e[2]);
  return result;
}

V bin_of(V position) {
  return {std::min(std::floor(position[0]), 89.0), std::min(std::floor(position[1]), 89.0),
          std::min(std::floor(position[2]), 179.0)};
}

/// The made-up measurement's raw values.
V rule(V bin) { return {30 * (bin[0] + 1), 20 * (bin[1] + 1), 10 * (bin[2] + 1)}; }

V scaled(V raw) { return {raw[0] / 1500, 1.15 * raw[1] / 1500, 1.66 * raw[2] / 1500}; }

void look_up(Numbers& page, V n, V wi, V wo) {
  const V t = norm(cross({0, 1, 0}, n));
  const V b = cross(n, t);
  const V i = {dot(t, wi), dot(b, wi), dot(n, wi)};
  const V o = {dot(t, wo), dot(b, wo), dot(n, wo)};
  const Angles angles = angles_of(i, o);
  const V bin = bin_of(angles.position());
  page.insert({{"T", list(t)}, {"B", list(b)}, {"i", list(i)}, {"o", list(o)}});
  page.insert({{"H", list(angles.h)}, {"e", list(angles.e)}, {"θ_h", {angles.theta_h}}});
  page.insert({{"θ_d", {angles.theta_d}}, {"φ_d", {angles.phi_d}}});
  page.insert({{"position", list(angles.position())}, {"bin", list(bin)}});
  page["index"] = {bin[2] + 180 * (bin[1] + 90 * bin[0])};
  page["raw"] = list(rule(bin));
  page["f_r"] = list(scaled(rule(bin)));
}

Numbers worked_by_hand() {
  Numbers page;
  V n;
  V wo;
  trace_camera(page, n, wo);
  const V wi = find_light(page);
  const double cosine = dot(n, wi);
  page["cosine"] = {cosine};
  look_up(page, n, wi, wo);
  const double radiance[3] = {2048, 1024, 512};
  for (std::size_t c = 0; c < 3; ++c)
    page["L_o"].push_back(page["f_r"][c] * radiance[c] * cosine * page["Ω"][0]);
  return page;
}

void replace_all(std::string& text, const std::string& what, const std::string& with) {
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at))
    text.replace(at, what.size(), with);
}

/// The last table of the page: numbers by name.
Numbers read_page() {
  std::ifstream file(std::string(HAARLIGHT_SOURCE_DIR) + "/renderer/CONVENTIONS.md");
  REQUIRE(file.good());
  Numbers result;
  std::string line;
  while (std::getline(file, line) && line != "## One pixel by hand") {
  }
  while (std::getline(file, line)) {
    if (line.rfind("| ", 0) != 0 || line.rfind("| |", 0) == 0)
      continue;
    std::string value = line.substr(line.rfind(" | ") + 3);
    replace_all(value, "−", "-");
    for (const char* other : {"(", ")", ",", "|"})
      replace_all(value, other, " ");
    std::istringstream stream(value);
    std::vector<double>& numbers = result[line.substr(2, line.find(" | ") - 2)];
    for (double number = 0; stream >> number;)
      numbers.push_back(number);
  }
  return result;
}

void write_rule(const std::string& path) {
  brdf::MerlTable table;
  for (int h = 0; h < 90; ++h)
    for (int d = 0; d < 90; ++d)
      for (int p = 0; p < 180; ++p) {
        const V raw =
            rule({static_cast<double>(h), static_cast<double>(d), static_cast<double>(p)});
        const auto index = static_cast<std::size_t>(p + 180 * (d + 90 * h));
        for (std::size_t c = 0; c < 3; ++c)
          table.raw[c * 90 * 90 * 180 + index] = raw[c];
      }
  brdf::write_merl(path, table);
}

void write_two_pixels(const std::string& path) {
  Image image(512, 512);
  image.set(216, 92, Rgb(2048, 1024, 512));
  image.set(200, 200, Rgb(2048, 1024, 512));
  probe::write_rgbe(path, image);
}

renderer::SceneDescription worked_scene(const TemporaryFolder& folder) {
  renderer::SceneDescription scene;
  scene.path = "test";
  scene.camera.from = Vec3(1, 0.5F, 4);
  scene.camera.fov = 35;
  scene.light.probe = folder.file("two_pixels.hdr");
  scene.light.mapping = "angular";
  scene.light.rotate = 30;
  renderer::MaterialDescription material;
  material.name = "rule";
  material.brdf = folder.file("rule.binary");
  scene.materials.push_back(material);
  scene.objects.push_back({renderer::Sphere{}, {}, 0});
  write_rule(material.brdf);
  write_two_pixels(scene.light.probe);
  return scene;
}

} // namespace

TEST_CASE("the numbers of the pixel worked in CONVENTIONS.md are right") {
  const Numbers page = read_page();
  const Numbers right = worked_by_hand();
  CHECK(page.size() == right.size());
  for (const auto& [name, numbers] : right) {
    INFO(name);
    REQUIRE(page.count(name) == 1);
    const std::vector<double>& printed = page.at(name);
    REQUIRE(printed.size() == numbers.size());
    for (std::size_t i = 0; i < numbers.size(); ++i) // six digits, or six behind the point
      CHECK(
          std::abs(printed[i] - numbers[i]) <
          std::max(5.01e-6 * std::abs(numbers[i]), std::abs(numbers[i]) < 0.01 ? 1e-10 : 5.01e-7));
  }
}

TEST_CASE("rendering gives the pixel worked in CONVENTIONS.md") {
  const TemporaryFolder folder;
  const renderer::LoadedScene scene(worked_scene(folder), {brdf::Lookup::Nearest},
                                    renderer::SamplerKind::Light, false);
  renderer::RenderOptions options;
  options.sampler = renderer::SamplerKind::Light;
  options.spp = 4096;
  const renderer::Film film = render(scene, options, 8, 6).film;
  const Numbers right = worked_by_hand();
  const std::size_t pixel = film.index(5, 2);
  for (std::size_t c = 0; c < 3; ++c) {
    CHECK(film.rgb[3 * pixel + c] == Approx(right.at("L_o")[c]).epsilon(1e-3));
    CHECK(film.normal[3 * pixel + c] == Approx(right.at("n")[c]).margin(1e-6));
  }
}

TEST_CASE("nearest look-up takes the bin that CONVENTIONS.md says") {
  const TemporaryFolder folder;
  write_rule(folder.file("rule.binary"));
  const brdf::MeasuredBrdf measured(folder.file("rule.binary"), brdf::Lookup::Nearest);
  std::mt19937 random(1);
  const auto number = [&] { return static_cast<double>(random() % 2000001U) / 1e6 - 1; };
  int different = 0; // where float rounding crosses the edge of a bin
  for (int k = 0; k < 20000; ++k) {
    const V i = norm({number(), number(), std::abs(number()) + 1e-3});
    const V o = norm({number(), number(), std::abs(number()) + 1e-3});
    const V right = scaled(rule(bin_of(angles_of(i, o).position())));
    const Rgb found = measured.evaluate(Eigen::Vector3d(i.data()).cast<float>(),
                                        Eigen::Vector3d(o.data()).cast<float>());
    for (int c = 0; c < 3; ++c)
      if (std::abs(static_cast<double>(found[c]) / right[static_cast<std::size_t>(c)] - 1) > 1e-5)
        ++different;
  }
  CHECK(different < 10);
}
