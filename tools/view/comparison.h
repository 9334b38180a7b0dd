#pragma once
// Frames as files, timed, and compared with reference pictures.

#include <support/report.h>
#include <view/frame.h>

#include <functional>
#include <string>
#include <vector>

namespace haarlight::view {

/// RGB of all pixels, top row first, from the same trees at full resolution on the CPU: one ray
/// through the centre of each pixel under the state's punctual light.
std::vector<float> cpu_punctual_frame(const ViewScene& scene, const ViewState& state);

/// The same under the distant light of the scene, by product integrals with visibility maps of 128²
/// squares; black where there is no object. @throws Error(Input) if a file is broken
std::vector<float> cpu_environment_frame(const renderer::SceneDescription& scene, int width,
                                         int height);

/// Reads a reference picture. @throws Error(Input) if it cannot be read or has another size
std::vector<float> read_reference(const std::string& path, int width, int height);

/// Root mean square of the difference, relative to that of the reference; 0 for two black pictures.
double relative_rms(const std::vector<float>& frame, const std::vector<float>& reference);

/// Median of the values that `run` returns in `repeat` calls, milliseconds.
double median_time(int repeat, const std::function<double()>& run);

/// A frame that is drawn at different levels.
struct FrameTest {
  const PictureDrawer& drawer;
  std::function<double(int level)> draw; ///< returns milliseconds
  int level;                             ///< of the frame
  int repeat;                            ///< draws that are timed

  /// Draws the frame and writes it as .exr, or tone-mapped as .png.
  /// @param exposure stops, of a .png @throws Error(Output)
  DrawnFrame write(const std::string& path, int width, int height, double exposure) const;
  /// Median time of the frame, milliseconds.
  double time() const {
    return median_time(repeat, [&] { return draw(level); });
  }
  /// Adds the relative error of the frame, and error and cost of every level up to `finest`. The
  /// background must be that of the reference.
  void compare(const std::vector<float>& reference, int finest, tool::Report& report) const;
};

} // namespace haarlight::view
