#include <view/window_picture.h>

#include <image/png.h>

#include <epoxy/gl.h>

namespace haarlight::view {

Image read_window(const Area& area) {
  const auto width = static_cast<std::size_t>(area.width);
  const std::size_t row = 3 * width;
  std::vector<unsigned char> codes(row * static_cast<std::size_t>(area.height));
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  glReadBuffer(GL_BACK);
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadPixels(0, 0, area.width, area.height, GL_RGB, GL_UNSIGNED_BYTE, codes.data());
  Image picture(area.width, area.height);
  for (std::size_t i = 0; i < codes.size(); ++i) {
    const std::size_t y = static_cast<std::size_t>(area.height) - 1 - i / row;
    picture.rgb[y * row + i % row] = image::srgb_value(codes[i]);
  }
  return picture;
}

} // namespace haarlight::view
