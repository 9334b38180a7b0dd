#include <view/panes.h>

#include <wavelet/base/error.h>
#include <wavelet/file/tree_set.h>

#include <algorithm>
#include <filesystem>
#include <functional>

namespace haarlight::view {
namespace {

namespace fs = std::filesystem;

using renderer::LightDescription;
using wavelet::SetInfo;

bool is_set(const std::string& path, const std::function<bool(const SetInfo&)>& accepts) {
  try {
    return accepts(wavelet::TreeSet(path, wavelet::Check::WhenUsed).info());
  } catch (const Error&) {
    return false;
  }
}

/// Files with an extension in the folder of `path`, without a leading "./".
std::vector<std::string> neighbours(const std::string& path, const std::string& extension) {
  std::vector<std::string> found;
  const fs::path folder = fs::path(path).parent_path();
  std::error_code ignored;
  for (const fs::directory_entry& entry :
       fs::directory_iterator(folder.empty() ? "." : folder, ignored))
    if (entry.path().extension() == extension && entry.is_regular_file(ignored))
      found.push_back((folder / entry.path().filename()).string());
  std::sort(found.begin(), found.end());
  return found;
}

std::vector<std::string> neighbour_sets(const std::string& path,
                                        const std::function<bool(const SetInfo&)>& accepts) {
  std::vector<std::string> found = neighbours(path, ".haar");
  std::erase_if(found, [&](const std::string& file) { return !is_set(file, accepts); });
  return found;
}

bool is_material(const SetInfo& info) {
  return info.kind == wavelet::SetKind::Brdf && info.cosine && info.rolls == 1;
}

bool is_light(const SetInfo& info) {
  return info.kind == wavelet::SetKind::Light && info.world_frame;
}

bool holds_trees(const std::string& path) { return wavelet::begins_as_tree_set(InputFile(path)); }

/// Other trees for the first material of a scene; a set of trees is its own scene, so other trees
/// replace it.
SceneChoice with_material(const std::string& scene, const std::string& trees) {
  return holds_trees(scene) ? SceneChoice{trees, {}} : SceneChoice{scene, trees};
}

void add_unique(const SceneChoice& choice, std::vector<SceneChoice>& choices) {
  if (std::find(choices.begin(), choices.end(), choice) == choices.end())
    choices.push_back(choice);
}

void add_materials(const WindowInput& input, Choices& choices) {
  std::vector<std::string> files = input.materials;
  const std::vector<std::string> found = neighbour_sets(input.scene, is_material);
  files.insert(files.end(), found.begin(), found.end());
  for (const std::string& path : files) {
    add_unique(with_material(input.scene, path), choices.materials);
    add_unique(with_material(input.scene, path), choices.others);
  }
}

void add_lights(const std::string& path, Choices& choices) {
  std::vector<std::string> files = neighbour_sets(path, is_light);
  const std::vector<std::string> images = neighbours(path, ".hdr");
  files.insert(files.end(), images.begin(), images.end());
  for (const std::string& file : files)
    if (std::none_of(choices.lights.begin(), choices.lights.end(),
                     [&](const auto& light) { return file_of(light) == file; }))
      choices.lights.push_back(describe_light(file));
}

std::vector<std::string> names_of(const std::vector<SceneChoice>& choices) {
  std::vector<std::string> names(choices.size());
  std::transform(choices.begin(), choices.end(), names.begin(),
                 [](const SceneChoice& choice) { return choice.name(); });
  names.front() = names.front().empty() ? "none" : names.front();
  return names;
}

std::vector<std::string> names_of(const std::vector<LightDescription>& lights) {
  std::vector<std::string> names(lights.size());
  std::transform(lights.begin(), lights.end(), names.begin(),
                 [](const auto& light) { return base_name(file_of(light)); });
  names.front() = "directional or point";
  return names;
}

} // namespace

Choices find_choices(const WindowInput& input, const LightDescription& light) {
  Choices choices = {{{input.scene, {}}}, {{}}, {{}}};
  if (!input.second.empty())
    choices.others.push_back(holds_trees(input.second) ? with_material(input.scene, input.second)
                                                       : SceneChoice{input.second, {}});
  add_materials(input, choices);
  if (!input.probe.empty())
    choices.lights.push_back(describe_light(input.probe));
  if (!file_of(light).empty())
    choices.lights.push_back(light);
  const std::string given = file_of(choices.lights.back());
  add_lights(given.empty() ? input.scene : given, choices);
  return choices;
}

PanelContents panel_contents(const Choices& choices) {
  PanelContents contents;
  contents.materials = names_of(choices.materials);
  contents.others = names_of(choices.others);
  contents.lights = names_of(choices.lights);
  return contents;
}

} // namespace haarlight::view
