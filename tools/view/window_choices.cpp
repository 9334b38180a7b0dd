#include <view/window_choices.h>

#include <wavelet/error.h>
#include <wavelet/input_file.h>
#include <wavelet/tree_set.h>

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

/// What is not among the choices yet.
void add(const std::vector<std::string>& found, std::vector<std::string>& choices) {
  for (const std::string& path : found)
    if (std::find(choices.begin(), choices.end(), path) == choices.end())
      choices.push_back(path);
}

} // namespace

std::vector<std::string> material_choices(const std::vector<std::string>& named,
                                          const std::string& neighbour) {
  std::vector<std::string> choices = named;
  add(sets(neighbour,
           [](const SetInfo& info) {
             return info.kind == wavelet::SetKind::Brdf && info.cosine && info.rolls == 1;
           }),
      choices);
  return choices;
}

std::vector<std::string> light_choices(const std::vector<std::string>& named,
                                       const std::string& neighbour) {
  std::vector<std::string> choices = named;
  add(sets(neighbour,
           [](const SetInfo& info) {
             return info.kind == wavelet::SetKind::Light && info.world_frame;
           }),
      choices);
  add(neighbours(neighbour, ".hdr"), choices);
  return choices;
}

} // namespace haarlight::view
