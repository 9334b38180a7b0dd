#pragma once
// The formulas among a scene's materials.

#include "scene/scene_node.h"

#include <brdf/analytic.h>

#include <optional>

namespace haarlight::renderer::detail {

/// Three numbers from 0 to 1.
Rgb read_albedo(const SceneNode& node);

/// Radiance: three numbers, none below 0.
Rgb read_emission(const SceneNode& node);

/// The keys of materials that name an analytic model.
Names model_names();

/// "a, b, c".
std::string joined(const Names& names);

/// The model whose key a material has; the first if it has several. Nothing if it has none.
std::optional<brdf::AnalyticBrdf> read_model(const SceneNode& material);

} // namespace haarlight::renderer::detail
