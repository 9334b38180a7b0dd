// haarprod: multiplies stored trees.
#include <support/program.h>
#include <support/tree_argument.h>
#include <support/words.h>

#include <wavelet/base/error.h>
#include <wavelet/file/file_hash.h>
#include <wavelet/product/multiply.h>
#include <wavelet/square/sphere_map.h>

#include <algorithm>
#include <cmath>
#include <optional>

using namespace haarlight;

namespace {

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
             "J, FILE.haar the first");
  app.optional_output(options.output, "-o,--output", "OUT.haar", "Write the product as a tree");
  app.flag(options.integral, "--integral", "Print the product's integral; the default without -o");
  app.value(options.factor, "--factor",
            "Multiply the first K trees to T1 and the rest to T2, print their inner product, which "
            "is the integral of all, and with -o write T1 and T2, columns 0 and 1, in place of the "
            "product",
            1, 65535);
  app.value(options.multiply.tolerance, "--tolerance",
            "Drop coefficients below this share of the product's mean luminance; 0 drops none", 0,
            1e6);
  app.choice(options.multiply.coefficients, "--coefficients",
             {{"half", wavelet::CoefficientType::Half}, {"float", wavelet::CoefficientType::Float}},
             "How coefficients are stored");
  app.offer_json();
}

std::vector<wavelet::TreeView> views_of(const std::vector<tool::NamedTree>& trees) {
  std::vector<wavelet::TreeView> views;
  views.reserve(trees.size());
  for (const tool::NamedTree& tree : trees)
    views.push_back(tree.view());
  return views;
}

/// Sources and options, for the header of what is written.
wavelet::SetInfo describe(const Options& options, const std::vector<tool::NamedTree>& trees,
                          int levels, int columns) {
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

/// Refuses factors whose product or integral no float can hold.
void require_range(bool holds, const std::vector<tool::NamedTree>& trees) {
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

tool::Report integral_report(const Rgb& mean, const std::vector<tool::NamedTree>& trees) {
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
  const std::vector<tool::NamedTree> trees = tool::open_trees(options.trees);
  if (const tool::NamedTree* tree = tool::out_of_frame(trees))
    app.note(tree->label() +
             ": is in another frame than the trees before it; all should share one");
  for (const tool::NamedTree& tree : trees)
    app.reads("FILE.haar", tree.set->path());
  const std::vector<wavelet::TreeView> views = views_of(trees);
  const std::size_t split = static_cast<std::size_t>(options.factor.value_or(0));
  if (options.factor && split >= views.size())
    throw tool::UsageError("--factor: leaves nothing to T2; it must be below the " +
                           std::to_string(views.size()) + " trees given");
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
  return tool::run_program(argc, argv, "haarprod",
                           "Multiplies trees of .haar files that share one frame.", declare,
                           multiply);
}
