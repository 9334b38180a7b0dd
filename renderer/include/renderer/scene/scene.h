#pragma once
// A scene as plain values: file names, shapes, camera. No
// files are loaded.

#include <renderer/scene/affine_map.h>
#include <renderer/shapes/shape.h>

#include <brdf/analytic.h>

#include <optional>
#include <string>
#include <vector>

namespace haarlight::renderer {

enum class CameraProjection {
  Perspective, ///< rays from one point
  Orthographic ///< parallel rays
};

/// Looks from `from` to `to`; the projection of `up` points upwards in the picture.
struct CameraDescription {
  CameraProjection projection = CameraProjection::Perspective;
  Vec3 from = Vec3(0, 0, 1);
  Vec3 to = Vec3::Zero();  ///< not `from`
  Vec3 up = Vec3::UnitY(); ///< not parallel to the view
  double fov = 30;         ///< perspective: vertical field of view, degrees, in (0, 180)
  double height = 2;       ///< orthographic: height of the picture, world units, > 0
};

/// Light from infinitely far. At least one of `probe`, `haar`, `table` is given.
struct LightDescription {
  std::string probe;            ///< image file, or empty
  std::string haar;             ///< tree of the one world-frame map, or empty
  std::string table;            ///< trees of the table of rotated maps, or empty
  std::string mapping = "auto"; ///< of `probe`: auto, angular, latlong, mirrorball or
                                ///< octahedral
  std::string layer;            ///< layer of `probe` (OpenEXR), or empty
  std::string part;             ///< part (OpenEXR) or page (TIFF) of `probe`, or empty
  double rotate = 0; ///< rotation of the light about world +y, degrees, right-handed: the light
                     ///< from ω is the probe's at ω rotated by −rotate
  bool background = true; ///< pixels without a hit show the light; else black
};

/// At least one of the files, or only `lambert` or `model`, or none of them: black. Any may be
/// emissive.
struct MaterialDescription {
  std::string name;
  std::string brdf;           ///< MERL file, or empty
  std::string haar;           ///< trees of the θ_r-only set, or empty
  std::string table;          ///< trees of the set with rolls, or empty
  std::optional<Rgb> lambert; ///< albedo in [0, 1]: f_r = lambert/π
  std::optional<brdf::AnalyticBrdf> model;
  Rgb emission = Rgb::Zero(); ///< radiance in all directions, on both sides; ≥ 0
};

struct ObjectDescription {
  Shape shape;
  AffineMap transform; ///< applied to the shape in world space
  int material = 0;    ///< index into SceneDescription::materials
};

/// File names are relative to the scene file's folder unless they are absolute.
struct SceneDescription {
  std::string path; ///< of the scene file
  std::string hash; ///< of its bytes, for provenance
  int width = 256;  ///< pixels
  int height = 256;
  CameraDescription camera;
  LightDescription light;
  std::vector<MaterialDescription> materials; ///< in the file's order
  std::vector<ObjectDescription> objects;     ///< in the file's order, as hits number them
  std::vector<std::string> object_names;      ///< of the objects in order, unique or empty; may be
                                              ///< shorter than `objects`
};

/// Reads and checks a scene file; the files it names are not opened. renderer/SCENE.md documents
/// the format.
/// @throws Error(Input) naming the place in the scene (as in `objects[2].radius`) and the expected
///         value, for: a file that cannot be read; a JSON syntax error (with byte, line and
///         column); a key that is unknown (with the nearest known key), missing or given twice; a
///         wrong type; a number out of its range; a direction of zero length; an unknown material;
///         a degenerate camera; a film that is too large
SceneDescription load_scene(const std::string& path);

} // namespace haarlight::renderer
