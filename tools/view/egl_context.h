#pragma once
// OpenGL ES 3.0 without a window or a screen.

#include <memory>
#include <string>

namespace haarlight::view {

/// A context on EGL's surfaceless platform (Mesa: the machine's GPU, or llvmpipe without one),
/// current to the thread that made it while it lives. One per process at a time.
class EglContext {
public:
  /// @throws Error(Output) saying what is missing, if there is no EGL, no surfaceless platform, or
  ///         no OpenGL ES 3.0 that draws to float images
  EglContext();
  ~EglContext();
  EglContext(const EglContext&) = delete;
  EglContext& operator=(const EglContext&) = delete;

  /// What draws, in the driver's words.
  std::string renderer() const;

private:
  struct Handles;
  std::unique_ptr<Handles> m_handles;
};

} // namespace haarlight::view
