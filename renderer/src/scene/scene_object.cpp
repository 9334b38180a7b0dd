#include "scene/scene_object.h"

namespace haarlight::renderer::detail {
namespace {

Shape read_sphere(const SceneNode& node) {
  return Sphere{node.at("center").vector(), node.at("radius").positive()};
}

Shape read_plane(const SceneNode& node) {
  return Plane{node.at("point").vector(), node.at("normal").direction()};
}

Shape read_disk(const SceneNode& node) {
  return Disk{node.at("center").vector(), node.at("normal").direction(),
              node.at("radius").positive()};
}

Shape read_box(const SceneNode& node) {
  const Box box{node.at("min").vector(), node.at("max").vector()};
  if (!(box.low.array() < box.high.array()).all())
    node.at("max").fail("must be above min in x, y and z");
  return box;
}

/// Two points that must differ: the ends of a cylinder or a cone.
Vec3 read_other_end(const SceneNode& node, const char* key, const Vec3& base) {
  Vec3 end = node.at(key).vector();
  if (end == base)
    node.at(key).fail("must not be the same point as base");
  return end;
}

Shape read_cylinder(const SceneNode& node) {
  const Vec3 base = node.at("base").vector();
  return Cylinder{base, read_other_end(node, "top", base), node.at("radius").positive()};
}

Shape read_cone(const SceneNode& node) {
  const Vec3 base = node.at("base").vector();
  return Cone{base, read_other_end(node, "apex", base), node.at("radius").positive()};
}

Shape read_torus(const SceneNode& node) {
  const Torus torus{node.at("center").vector(), node.at("axis").direction(),
                    node.at("major_radius").positive(), node.at("minor_radius").positive()};
  if (!(torus.minor_radius < torus.major_radius))
    node.at("minor_radius").fail("must be below major_radius");
  return torus;
}

/// What a shape type is called, the keys it has of its own, and how it is read.
struct ShapeReader {
  std::string_view type;
  Names keys;
  Shape (*read)(const SceneNode&);
};

const std::vector<ShapeReader>& shape_readers() {
  static const std::vector<ShapeReader> readers = {
      {"sphere", {"center", "radius"}, read_sphere},
      {"plane", {"point", "normal"}, read_plane},
      {"disk", {"center", "normal", "radius"}, read_disk},
      {"box", {"min", "max"}, read_box},
      {"cylinder", {"base", "top", "radius"}, read_cylinder},
      {"cone", {"base", "apex", "radius"}, read_cone},
      {"torus", {"center", "axis", "major_radius", "minor_radius"}, read_torus}};
  return readers;
}

const ShapeReader& reader_of(const SceneNode& type) {
  const std::string name = type.text();
  Names known;
  for (const ShapeReader& reader : shape_readers()) {
    if (reader.type == name)
      return reader;
    known.push_back(reader.type);
  }
  type.fail_unknown("shape", name, known);
}

Eigen::Vector3d to_vector(const std::vector<double>& v) { return {v[0], v[1], v[2]}; }

AffineMap read_rotation(const SceneNode& node) {
  if (!node.is_object())
    return euler_rotation(to_vector(node.numbers(3)));
  node.allow({"axis", "angle"});
  return rotation(node.at("axis").direction().cast<double>(), node.at("angle").number());
}

AffineMap read_scaling(const SceneNode& node) {
  const Eigen::Vector3d factors =
      node.is_number() ? Eigen::Vector3d::Constant(node.number()) : to_vector(node.numbers(3));
  if ((factors.array() == 0).any())
    node.fail("must not be zero");
  return scaling(factors);
}

AffineMap read_matrix(const SceneNode& node) {
  const std::vector<double> m = node.numbers(16);
  if (m[12] != 0 || m[13] != 0 || m[14] != 0 || m[15] != 1)
    node.fail("must end with the row 0, 0, 0, 1");
  AffineMap result;
  result.linear << m[0], m[1], m[2], m[4], m[5], m[6], m[8], m[9], m[10];
  result.offset << m[3], m[7], m[11];
  return result;
}

AffineMap read_step(const SceneNode& node) {
  const Names known = {"translate", "rotate", "scale", "matrix"};
  node.allow(known);
  if (node.keys().size() != 1)
    node.fail("must hold exactly one of translate, rotate, scale, matrix; put several steps in an "
              "array, in the order they apply");
  if (const auto step = node.find("translate"))
    return translation(to_vector(step->numbers(3)));
  if (const auto step = node.find("rotate"))
    return read_rotation(*step);
  if (const auto step = node.find("scale"))
    return read_scaling(*step);
  return read_matrix(node.at("matrix"));
}

AffineMap read_transform(const SceneNode& node) {
  AffineMap result;
  if (node.is_object())
    result = read_step(node);
  else
    for (const SceneNode& step : node.elements())
      result = result.then(read_step(step));
  if (!result.usable())
    node.fail("cannot be inverted within the range of numbers: flattens, or scales too far");
  return result;
}

} // namespace

ObjectDescription read_object(const SceneNode& node) {
  const ShapeReader& reader = reader_of(node.at("type"));
  Names keys = {"type", "material", "transform", "name"};
  keys.insert(keys.end(), reader.keys.begin(), reader.keys.end());
  node.allow(keys);
  ObjectDescription object;
  object.shape = reader.read(node);
  if (const auto transform = node.find("transform"))
    object.transform = read_transform(*transform);
  return object;
}

} // namespace haarlight::renderer::detail
