#include <renderer/transfer/relight.h>

#include <wavelet/base/error.h>

#include <stdexcept>

namespace haarlight::renderer {

bool is_transfer(const wavelet::SetInfo& info) {
  return info.kind == wavelet::SetKind::Transfer || info.provenance.get("transfer") == "1";
}

Transfer::Transfer(const std::string& path) : m_set(wavelet::open_tree_set(path)) {
  if (varying_text().empty() || !is_transfer(m_set.info()))
    throw_input_error(path, "holds no transfer; haarrelight build makes files that do");
  m_trees.reserve(static_cast<std::size_t>(width()) * static_cast<std::size_t>(height()));
  for (int y = 0; y < height(); ++y)
    for (int x = 0; x < width(); ++x)
      m_trees.push_back(m_set.tree(x, y));
}

Variation Transfer::variation(const SceneDescription& scene) const {
  if (scene.hash != provenance().get("scene_hash"))
    throw_input_error(scene.path, std::string("is not the scene that ")
                                      .append(path())
                                      .append(" was made of, ")
                                      .append(scene_name())
                                      .append(" of hash ")
                                      .append(provenance().get("scene_hash")));
  try {
    return variation_from_text(scene, varying_text());
  } catch (const std::invalid_argument& problem) {
    throw_input_error(path(), problem.what());
  }
}

} // namespace haarlight::renderer
