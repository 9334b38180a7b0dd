#pragma once
// Reading scene files. renderer/SCENE.md documents the format.

#include <renderer/scene/scene.h>

#include <string>

namespace haarlight::renderer {

/// Reads and checks a scene; the files it names are not opened.
/// @throws Error(Input) naming the place in the scene (as in `objects[2].radius`) and what would be
///         right, for: a file that cannot be read or is no JSON (with the byte offset), a key that
///         is unknown (with the nearest known) or given twice, a missing key, a wrong type, a
///         number out of its range, a direction of zero length, an unknown material, a camera that
///         looks nowhere, a film that is too large
SceneDescription load_scene(const std::string& path);

} // namespace haarlight::renderer
