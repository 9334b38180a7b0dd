#pragma once
// The `objects` of a scene file.

#include "scene/scene_node.h"

#include <renderer/scene/scene.h>

namespace haarlight::renderer::detail {

/// One shape with its transform. The key `material` is allowed, and left to the caller.
ObjectDescription read_object(const SceneNode& node);

} // namespace haarlight::renderer::detail
