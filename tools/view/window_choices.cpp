#include <view/window_choices.h>

#include <view/window_light.h>

#include <wavelet/base/error.h>
#include <wavelet/file/input_file.h>
#include <wavelet/file/tree_set.h>

#include <algorithm>
#include <filesystem>
#include <functional>

namespace haarlight::view {
namespace {

namespace fs = std::filesystem;

using wavelet::SetInfo;

bool is_set(const std::string& path, const std::function<bool(const SetInfo&)>& wanted) {
  try {
    return wanted(wavelet::TreeSet(path, wavelet::Check::WhenUsed).info());
  } catch (const Error&) {
    return false;
  }
}

/// Names as they would be typed: without a "./" in front.
std::vector<std::string> neighbours(const std::string& path, const std::string& extension) {
  std::vector<std::string> found;
  const fs::path folder = fs::path(path).parent_path();
  std::error_code none;
  for (const fs::directory_entry& entry :
       fs::directory_iterator(folder.empty() ? "." : folder, none))
    if (entry.path().extension() == extension && entry.is_regular_file(none))
      found.push_back((folder / entry.path().filename()).string());
  std::sort(found.begin(), found.end());
  return found;
}

std::vector<std::string> sets(const std::string& neighbour,
                              const std::function<bool(const SetInfo&)>& wanted) {
  std::vector<std::string> found = neighbours(neighbour, ".haar");
  std::erase_if(found, [&](const std::string& path) { return !is_set(path, wanted); });
  return found;
}

bool is_material(const SetInfo& info) {
  return info.kind == wavelet::SetKind::Brdf && info.cosine && info.rolls == 1;
}

bool is_light(const SetInfo& info) {
  return info.kind == wavelet::SetKind::Light && info.world_frame;
}

bool holds_trees(const std::string& path) { return wavelet::begins_as_tree_set(InputFile(path)); }

/// A set of trees is its own scene, so trees take its place as a whole.
Subject with_material(const std::string& scene, const std::string& trees) {
  return holds_trees(scene) ? Subject{trees, {}} : Subject{scene, trees};
}

void add(const Subject& subject, std::vector<Subject>& subjects) {
  if (std::find(subjects.begin(), subjects.end(), subject) == subjects.end())
    subjects.push_back(subject);
}

void add_materials(const WindowInput& input, WindowChoices& choices) {
  std::vector<std::string> files = input.materials;
  const std::vector<std::string> found = sets(input.scene, is_material);
  files.insert(files.end(), found.begin(), found.end());
  for (const std::string& path : files) {
    add(with_material(input.scene, path), choices.materials);
    add(with_material(input.scene, path), choices.others);
  }
}

void add_lights(const std::string& neighbour, WindowChoices& choices) {
  std::vector<std::string> files = sets(neighbour, is_light);
  const std::vector<std::string> images = neighbours(neighbour, ".hdr");
  files.insert(files.end(), images.begin(), images.end());
  for (const std::string& path : files)
    if (std::none_of(choices.lights.begin(), choices.lights.end(),
                     [&](const auto& light) { return file_of(light) == path; }))
      choices.lights.push_back(light_of_file(path));
}

std::vector<std::string> names_of(const std::vector<Subject>& subjects) {
  std::vector<std::string> names(subjects.size());
  std::transform(subjects.begin(), subjects.end(), names.begin(),
                 [](const Subject& subject) { return subject.name(); });
  names.front() = names.front().empty() ? "nothing" : names.front();
  return names;
}

std::vector<std::string> names_of(const std::vector<renderer::LightDescription>& lights) {
  std::vector<std::string> names(lights.size());
  std::transform(lights.begin(), lights.end(), names.begin(),
                 [](const auto& light) { return base_name(file_of(light)); });
  names.front() = "lamp";
  return names;
}

} // namespace

WindowChoices choices_of(const WindowInput& input, const renderer::LightDescription& light) {
  WindowChoices choices = {{{input.scene, {}}}, {{}}, {{}}};
  if (!input.against.empty())
    choices.others.push_back(holds_trees(input.against) ? with_material(input.scene, input.against)
                                                        : Subject{input.against, {}});
  add_materials(input, choices);
  if (!input.probe.empty())
    choices.lights.push_back(light_of_file(input.probe));
  if (!file_of(light).empty())
    choices.lights.push_back(light);
  const std::string given = file_of(choices.lights.back());
  add_lights(given.empty() ? input.scene : given, choices);
  return choices;
}

PanelContents contents_of(const WindowChoices& choices) {
  PanelContents contents;
  contents.materials = names_of(choices.materials);
  contents.others = names_of(choices.others);
  contents.lights = names_of(choices.lights);
  return contents;
}

} // namespace haarlight::view
