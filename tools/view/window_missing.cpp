#include <view/window.h>

#include <wavelet/base/error.h>

namespace haarlight::view {
namespace {

[[noreturn]] void throw_window_missing() {
  throw_output_error("window", "was left out of this build, which found no GLFW and Dear ImGui "
                               "(--image draws without a window)");
}

} // namespace

WindowReport show_window(const WindowInput&, const std::function<void(const std::string&)>&) {
  throw_window_missing();
}

WindowReport show_transfer(const renderer::Transfer&, const renderer::SceneDescription&,
                           const TransferWindowInput&) {
  throw_window_missing();
}

} // namespace haarlight::view
