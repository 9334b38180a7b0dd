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

} // namespace

std::vector<std::string> material_choices(const std::vector<std::string>& named,
                                          const std::string& neighbour) {
  const auto shown = [](const SetInfo& info) {
    return info.kind == wavelet::SetKind::Brdf && info.cosine && info.rolls == 1;
  };
  std::vector<std::string> choices = named;
  for (const std::string& path : neighbours(neighbour, ".haar"))
    if (std::find(choices.begin(), choices.end(), path) == choices.end() && is_set(path, shown))
      choices.push_back(path);
  return choices;
}

} // namespace haarlight::view
