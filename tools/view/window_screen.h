#pragma once
// A window on the screen, with OpenGL 3.3 and controls over it.

#include <view/gl_objects.h>
#include <view/window_gestures.h>
#include <wavelet/base/image.h>

#include <memory>
#include <string>

namespace haarlight::view {

/// Its context is current to the thread that made it while it lives. One per process at a time.
/// A turn is: begin(); controls are declared to Dear ImGui and pictures drawn to framebuffer 0, in
/// any order; end().
class Screen {
public:
  /// @throws Error(Output) saying what is missing, if there is no display or no OpenGL 3.3
  Screen(int width, int height, const std::string& title);
  ~Screen();
  Screen(const Screen&) = delete;
  Screen& operator=(const Screen&) = delete;

  /// Until the user closes the window, by Escape as well.
  bool is_open() const;

  /// @param patience to wait for something to happen, seconds
  Gestures begin(double patience);
  /// Puts the controls over what was drawn; then it can be seen.
  /// @param picture receives all that, if not null
  void end(Image* picture);

  /// All of the window, pixels.
  Area area() const;
  /// What draws, in the driver's words.
  std::string renderer() const;
  /// Whether turns take the screen's rhythm, or none.
  void pace(bool paced);

private:
  struct Parts;
  std::unique_ptr<Parts> m_parts;
};

} // namespace haarlight::view
