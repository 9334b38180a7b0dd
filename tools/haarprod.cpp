// haarprod: multiplies stored trees.
#include <support/arguments.h>
#include <support/tool.h>

#include <wavelet/base/error.h>
#include <wavelet/file/input_file.h>
#include <wavelet/file/tree_set.h>
#include <wavelet/product/multiply.h>
#include <wavelet/square/sphere_map.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <optional>

using namespace haarlight;

namespace {

/// A tree, and the set that keeps it.
struct NamedTree {
  std::shared_ptr<const wavelet::TreeSet> set;
  wavelet::MapPlace place;

  const wavelet::TreeView& view() const { return set->tree(place.column, place.row); }

  /// As in grace.haar[0,0], without directories.
  std::string label() const {
    return base_name(set->path()) + "[" + std::to_string(place.column) + "," +
           std::to_string(place.row) + "]";
  }
};

struct TreeArgument {
  std::string path;
  std::vector<double> place;
};

TreeArgument parsed(const std::string& word) {
  if (word.empty() || word.back() != ']')
    return {word, {0, 0}};
  const std::size_t open = word.rfind('[');
  if (open == std::string::npos || open == 0)
    return {word, {0, 0}};
  return {word.substr(0, open),
          tool::parse_numbers(word.substr(open + 1, word.size() - open - 2), 2, 0, 65535)};
}

/// Opens each file once. @throws UsageError for words of another form and for trees that a set
/// lacks
std::vector<NamedTree> open_trees(const std::vector<std::string>& words) {
  std::map<std::string, std::shared_ptr<const wavelet::TreeSet>> sets;
  std::vector<NamedTree> trees;
  for (const std::string& text : words) {
    const TreeArgument word = parsed(text);
    auto& set = sets[word.path];
    if (!set)
      set = std::make_shared<wavelet::TreeSet>(word.path);
    trees.push_back({set, tool::chosen_map(word.place, set->info(), text)});
  }
  return trees;
}

/// The first tree in the world frame while an earlier one is not, or vice versa; nullptr if none
/// is. Generic trees, such as products, have no known frame.
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

struct Options {
  std::vector<std::string> trees;
  std::string output;
  bool integral = false;
  std::optional<int> factor;
  wavelet::MultiplyOptions multiply;
  Options() { multiply.coefficients = wavelet::CoefficientType::Half; }
};

void declare(tool::Tool& app, Options& options) {
  app.inputs(options.trees, "FILE.haar",
             "Trees to multiply, all in one frame: FILE.haar[I,J] is the tree of column I and row "
             "J, FILE.haar that of 0,0");
  app.optional_output(options.output, "-o,--output", "OUT.haar", "Tree to write: the product");
  app.flag(options.integral, "--integral", "Print the integral of the product, as without -o");
  app.value(options.factor, "--factor",
            "K: multiply the first K trees to T1 and the others to T2, print their inner product, "
            "which is the integral of all, and with -o write T1 and T2 (columns 0 and 1) instead "
            "of the product",
            1, 65535);
  app.value(options.multiply.tolerance, "--threshold",
            "Drop coefficients below this fraction of the product's mean luminance; 0 drops none",
            0, 1e6);
  app.choice(options.multiply.coefficients, "--coefficients",
             {{"half", wavelet::CoefficientType::Half}, {"float", wavelet::CoefficientType::Float}},
             "Precision of stored coefficients: 16 or 32 bits");
  app.alias("--tolerance", "--threshold");
  app.offer_json();
}

std::vector<wavelet::TreeView> views_of(const std::vector<NamedTree>& trees) {
  std::vector<wavelet::TreeView> views;
  views.reserve(trees.size());
  for (const NamedTree& tree : trees)
    views.push_back(tree.view());
  return views;
}

/// Sources and options, for the header of what is written.
wavelet::SetInfo describe(const Options& options, const std::vector<NamedTree>& trees, int levels,
                          int columns) {
  wavelet::SetInfo info;
  info.size = 1 << levels;
  info.columns = columns;
  info.frame = "that of the factors, which all share it";
  info.units = "product of the factors' units";
  Provenance& provenance = info.provenance;
  for (std::size_t i = 0; i < trees.size(); ++i) {
    const std::string name = "factor" + std::to_string(i + 1);
    provenance.set(name, trees[i].label());
    provenance.set(name + "_hash", file_hash(trees[i].set->path()));
  }
  if (options.factor)
    provenance.set("split", std::to_string(*options.factor));
  provenance.set("tolerance", tool::short_text(options.multiply.tolerance));
  provenance.set("version", version_text());
  return info;
}

bool is_finite(const wavelet::TreeView& tree) {
  if (!tree.mean.isFinite().all() || !std::isfinite(tree.scale))
    return false;
  for (std::uint32_t node = 0; node < tree.node_count; ++node) {
    const wavelet::Details details = tree.details(node);
    for (const Float4 d : {details.d1, details.d2, details.d3})
      if (!wavelet::to_rgb(d).isFinite().all())
        return false;
  }
  return true;
}

/// Refuses factors whose product or integral exceeds the range of float.
void require_range(bool holds, const std::vector<NamedTree>& trees) {
  if (!holds)
    throw_input_error(trees.back().set->path(), "multiplied by the other trees, exceeds the "
                                                "largest single-precision number");
}

void write(const std::string& path, const wavelet::SetInfo& info,
           const std::vector<wavelet::Tree>& trees) {
  OutputFile file(path);
  wavelet::TreeSetWriter writer(file, info, trees[0].channels, trees[0].type);
  for (const wavelet::Tree& tree : trees)
    writer.add(tree);
  writer.finish();
  file.commit([](const std::string& written) { const wavelet::TreeSet check(written); });
}

tool::Report integral_report(const Rgb& mean, const std::vector<NamedTree>& trees) {
  tool::Report report;
  const Rgb integral = mean * wavelet::sphere_area;
  require_range(integral.isFinite().all(), trees);
  const auto list = [](const Rgb& c) {
    return std::vector<double>{static_cast<double>(c[0]), static_cast<double>(c[1]),
                               static_cast<double>(c[2])};
  };
  report.add("mean", list(mean)).add("integral", list(integral), "over the sphere, dω");
  return report;
}

/// What the trees have in common, since all of a file's trees are alike.
wavelet::MultiplyOptions common_form(const Options& options,
                                     const std::vector<wavelet::TreeView>& views) {
  wavelet::MultiplyOptions form = options.multiply;
  for (const wavelet::TreeView& view : views) {
    form.levels = std::max(form.levels, view.levels);
    form.channels = std::max(form.channels, view.channels);
  }
  return form;
}

int multiply(const tool::Tool& app, const Options& options) {
  const std::vector<NamedTree> trees = open_trees(options.trees);
  if (const NamedTree* tree = out_of_frame(trees))
    app.note(tree->label() +
             ": is in another frame than the trees before it; all should share one frame");
  for (const NamedTree& tree : trees)
    app.reads("FILE.haar", tree.set->path());
  const std::vector<wavelet::TreeView> views = views_of(trees);
  const std::size_t split = static_cast<std::size_t>(options.factor.value_or(0));
  if (options.factor && split >= views.size())
    throw tool::UsageError("--factor: T2 would be empty; it must be below the number of trees, " +
                           std::to_string(views.size()));
  const wavelet::MultiplyOptions form = common_form(options, views);
  std::vector<wavelet::Tree> products;
  if (options.factor) {
    products.push_back(wavelet::multiply(std::span(views).first(split), form));
    products.push_back(wavelet::multiply(std::span(views).subspan(split), form));
  } else if (!options.output.empty()) {
    products.push_back(wavelet::multiply(views, form));
  }
  require_range(std::all_of(products.begin(), products.end(),
                            [](const wavelet::Tree& tree) { return is_finite(tree.view()); }),
                trees);
  std::optional<tool::Report> integral;
  if (options.factor)
    integral =
        integral_report(wavelet::inner_product(products[0].view(), products[1].view()), trees);
  else if (options.integral || options.output.empty())
    integral = integral_report(wavelet::product_integral(views), trees);
  if (!options.output.empty())
    write(options.output, describe(options, trees, form.levels, static_cast<int>(products.size())),
          products);
  if (integral)
    app.print(*integral);
  return tool::exit_ok;
}

} // namespace

int main(int argc, char** argv) {
  return tool::run_program(argc, argv,
                           tool::command("haarprod",
                                         "Multiplies trees of .haar files that share one frame.",
                                         declare, multiply));
}
