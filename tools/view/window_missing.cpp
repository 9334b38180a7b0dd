#include <view/transfer_window.h>
#include <view/window.h>

#include <wavelet/base/error.h>

namespace haarlight::view {
namespace {

[[noreturn]] void refuse() {
  throw_output_error("window", "was left out of this build, which found no GLFW and Dear ImGui "
                               "(--frame draws without a window)");
}

} // namespace

WindowReport show_window(const WindowInput&, const std::function<void(const std::string&)>&) {
  refuse();
}

WindowReport show_transfer(const renderer::Transfer&, const renderer::SceneDescription&,
                           const TransferWindowInput&) {
  refuse();
}

} // namespace haarlight::view
