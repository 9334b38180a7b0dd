#pragma once
// Frames timed, and held against pictures of which more is known.

#include <support/report.h>
#include <view/view_options.h>

#include <functional>
#include <string>
#include <vector>

namespace haarlight::view {

/// Draws frames of one kind.
struct Drawing {
  std::function<double(int level)> draw; ///< ms
  std::function<DrawnFrame()> read;      ///< what was drawn last
  int repeat;                            ///< frames whose times count

  /// Median time of a frame, ms.
  double time(int level) const;
};

/// What frames are compared with, as the options have it; nothing if they are not.
/// @param film the scene with the size and the light that are drawn
/// @throws Error(Input) if it cannot be read, or is of another size
std::vector<float> reference_of(const ViewScene& scene, const renderer::SceneDescription& film,
                                const Options& options);

/// The picture of `--reference`. @throws Error(Input) if it cannot be read, or is of another size
std::vector<float> read_reference(const std::string& path, int width, int height);

/// Adds the relative error of the frame of `level`, then error and cost of each level up to the
/// finest. Backgrounds have to be as in the reference.
void add_comparison(const Drawing& drawing, int level, int finest,
                    const std::vector<float>& reference, tool::Report& report);

/// Beyond it frames do not change.
int finest_level(const ViewScene& scene, const Options& options);

} // namespace haarlight::view
