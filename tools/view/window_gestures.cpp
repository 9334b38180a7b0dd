#include <view/window_gestures.h>

#include <imgui.h>

namespace haarlight::view {

Gestures mouse_gestures() {
  const ImGuiIO& io = ImGui::GetIO();
  Gestures found;
  found.moving = ImGui::IsAnyMouseDown();
  if (io.WantCaptureMouse)
    return found;
  const auto dragged = [&](ImGuiMouseButton button, double& x, double& y) {
    if (!ImGui::IsMouseDown(button))
      return;
    x = static_cast<double>(io.MouseDelta.x);
    y = static_cast<double>(io.MouseDelta.y);
  };
  dragged(ImGuiMouseButton_Left, found.orbit_x, found.orbit_y);
  dragged(ImGuiMouseButton_Right, found.light_x, found.light_y);
  found.wheel = static_cast<double>(io.MouseWheel);
  found.moving = found.moving || found.wheel != 0;
  return found;
}

} // namespace haarlight::view
