#pragma once
// Pictures from transfer, drawn by GL, for whatever owns the context.

#include <view/frame.h>
#include <view/gl_textures.h>

namespace haarlight::view {

/// Transfer and a light in textures, and the image they are drawn to. Needs the same of GL as
/// FrameDrawer.
class TransferDrawer {
public:
  /// @param transfer of pack_transfer(), for a film of this size
  /// @throws Error(Output) if it is larger than GL takes
  TransferDrawer(const PackedScene& transfer, int width, int height);

  /// The light to draw by from now on, of TransferLight::turned(). To be said before draw().
  void set_light(const PackedScene& light);

  /// Draws and waits until that is done.
  /// @param level of the finest squares over which light and transfer are told apart, 0 … 13
  /// @return milliseconds
  double draw(int level) const;

  /// The picture drawn last.
  DrawnFrame read() const { return read_frame(m_canvas); }

  /// Puts it, tone-mapped, into an area of a framebuffer, as FrameDrawer does.
  void show(unsigned framebuffer, const Area& area, double exposure) const {
    show_picture(m_canvas, m_show, m_cover, framebuffer, area, exposure);
  }

  std::size_t texture_bytes() const { return m_textures.bytes(); }

private:
  Cover m_cover;
  Program m_relight;
  Program m_show;
  Canvas m_canvas;
  NamedTextures m_textures;
};

} // namespace haarlight::view
