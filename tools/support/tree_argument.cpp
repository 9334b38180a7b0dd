#include <support/tree_argument.h>

#include <support/map_choice.h>
#include <support/words.h>

#include <wavelet/file/input_file.h>

#include <map>

namespace haarlight::tool {
namespace {

struct Word {
  std::string path;
  std::vector<double> place;
};

Word parsed(const std::string& word) {
  if (word.empty() || word.back() != ']')
    return {word, {0, 0}};
  const std::size_t open = word.rfind('[');
  if (open == std::string::npos || open == 0)
    return {word, {0, 0}};
  return {word.substr(0, open),
          numbers_of(word.substr(open + 1, word.size() - open - 2), 2, 0, 65535)};
}

} // namespace

std::string NamedTree::label() const {
  return base_name(set->path()) + "[" + std::to_string(place.column) + "," +
         std::to_string(place.row) + "]";
}

std::vector<NamedTree> open_trees(const std::vector<std::string>& words) {
  std::map<std::string, std::shared_ptr<const wavelet::TreeSet>> sets;
  std::vector<NamedTree> trees;
  for (const std::string& text : words) {
    const Word word = parsed(text);
    auto& set = sets[word.path];
    if (!set)
      set = std::make_shared<wavelet::TreeSet>(word.path);
    trees.push_back({set, chosen_map(word.place, set->info(), text)});
  }
  return trees;
}

const NamedTree* out_of_frame(const std::vector<NamedTree>& trees) {
  const NamedTree* first = nullptr;
  for (const NamedTree& tree : trees) {
    const wavelet::SetInfo& info = tree.set->info();
    if (info.kind != wavelet::SetKind::Brdf && info.kind != wavelet::SetKind::Light)
      continue;
    if (first == nullptr)
      first = &tree;
    if (first->set->info().world_frame != info.world_frame)
      return &tree;
  }
  return nullptr;
}

} // namespace haarlight::tool
