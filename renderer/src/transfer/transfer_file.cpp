// Transfer files: the text form of variations, and files opened for relighting.

#include <renderer/transfer/relight.h>
#include <renderer/transfer/transfer.h>

#include <wavelet/base/error.h>

#include <algorithm>
#include <charconv>
#include <stdexcept>

namespace haarlight::renderer {
namespace {

constexpr const char* object_prefix = "object:";
constexpr const char* material_prefix = "material:";

bool begins_with(const std::string& text, const std::string& prefix) {
  return text.compare(0, prefix.size(), prefix) == 0;
}

int material_index(const SceneDescription& scene, const std::string& name) {
  std::string known;
  for (std::size_t i = 0; i < scene.materials.size(); ++i) {
    if (scene.materials[i].name == name)
      return static_cast<int>(i);
    known.append(i == 0 ? "" : ", ").append(scene.materials[i].name);
  }
  throw std::invalid_argument("the scene has no material '" + name + "'; it has " + known);
}

int object_index(const SceneDescription& scene, const std::string& name) {
  const auto& names = scene.object_names;
  const auto named = std::find(names.begin(), names.end(), name);
  if (!name.empty() && named != names.end())
    return static_cast<int>(named - names.begin());
  int number = -1;
  const char* const end = name.data() + name.size();
  const auto read = std::from_chars(name.data(), end, number);
  const auto count = static_cast<int>(scene.objects.size());
  if (read.ec == std::errc() && read.ptr == end && number >= 0 && number < count)
    return number;
  throw std::invalid_argument("the scene has no object '" + name +
                              "'; give its \"name\" or its number, 0 to " +
                              std::to_string(count - 1));
}

} // namespace

std::string variation_text(const SceneDescription& scene, const Variation& variation) {
  const auto index = static_cast<std::size_t>(std::max(variation.index, 0));
  switch (variation.varying) {
  case Varying::Light:
    return "light";
  case Varying::View:
    return "view";
  case Varying::Object:
    return object_prefix + std::to_string(index);
  case Varying::Material:
    break;
  }
  return material_prefix + scene.materials[index].name;
}

Variation variation_from_text(const SceneDescription& scene, const std::string& text) {
  if (text == "light")
    return {Varying::Light, -1};
  if (text == "view")
    return {Varying::View, -1};
  if (begins_with(text, object_prefix))
    return {Varying::Object, object_index(scene, text.substr(std::string(object_prefix).size()))};
  if (begins_with(text, material_prefix))
    return {Varying::Material,
            material_index(scene, text.substr(std::string(material_prefix).size()))};
  throw std::invalid_argument("'" + text +
                              "' is not one of light, object:NAME, material:NAME, view");
}

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
    throw_input_error(scene.path, std::string("is not the scene of ")
                                      .append(path())
                                      .append(", which is ")
                                      .append(scene_name())
                                      .append(" with hash ")
                                      .append(provenance().get("scene_hash")));
  try {
    return variation_from_text(scene, varying_text());
  } catch (const std::invalid_argument& problem) {
    throw_input_error(path(), problem.what());
  }
}

} // namespace haarlight::renderer
