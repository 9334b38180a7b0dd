#include <view/transfer_drawer.h>

#include <view/shaders.h>
#include <view/transfer_packing.h>

#include <chrono>

namespace haarlight::view {

TransferDrawer::TransferDrawer(const PackedScene& transfer, int width, int height)
    : m_relight(covering_vertex_shader(), relight_fragment_shader()),
      m_show(covering_vertex_shader(), show_fragment_shader()), m_canvas(width, height) {
  for (const PackedTexture& texture : transfer.textures)
    m_textures.put(texture);
}

void TransferDrawer::set_light(const PackedScene& light) {
  for (const PackedTexture& texture : light.textures)
    m_textures.put(texture);
  for (const auto& [name, values] : light.floats)
    m_relight.set(name, values);
}

double TransferDrawer::draw(int level) const {
  m_relight.set("squares_end", squares_above(level));
  m_textures.bind(m_relight);
  const auto begin = std::chrono::steady_clock::now();
  m_canvas.draw(m_cover);
  const std::chrono::duration<double, std::milli> passed = std::chrono::steady_clock::now() - begin;
  return passed.count();
}

} // namespace haarlight::view
