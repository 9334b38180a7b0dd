// haarinfo: statistics, validation and pictures of a .haar file.
#include <html/page.h>
#include <info/page.h>
#include <support/arguments.h>
#include <support/tool.h>

#include <image/image_exr.h>
#include <image/png.h>

#include <wavelet/base/error.h>
#include <wavelet/file/tree_set.h>

using namespace haarlight;

namespace {

enum class Dump { None, Csv };

struct Options {
  std::string path;
  bool validate = false;
  std::vector<double> tree;
  std::optional<int> level;
  std::string image;
  std::string page;
  std::string reference;
  Dump dump = Dump::None;
};

void declare(tool::Tool& app, Options& options) {
  app.input(options.path, "FILE.haar", "File to inspect");
  app.flag(options.validate, "--validate", "Only validate the file; exit code 1 if it is invalid");
  app.values(options.tree, "--tree", "Column and row of the only tree to inspect [all]", 2, 0,
             65535);
  app.value(options.level, "--level",
            "Level of reconstruction: 2^level pixels along a side [the finest; for a picture of "
            "all trees the finest within 2048 pixels along a side]",
            0, 13);
  app.optional_output(options.image, "--image", "OUT.png|OUT.exr",
                      "Picture to write, of the tree or of all trees: .png scaled to a mean of "
                      "0.18 and tone mapped, .exr with linear values");
  app.optional_output(
      options.page, "--html", "REPORT.html",
      "Page to write, self-contained: pictures of at most 1024 pixels along a side, statistics by "
      "level, error by number of coefficients and, for BRDF sets, lobes");
  app.optional_input(options.reference, "--reference", "MAPS.exr|OTHER.haar",
                     "With --html: the maps that the trees approximate; the page shows the three "
                     "maps that differ most");
  app.choice(options.dump, "--dump", {{"csv", Dump::Csv}},
             "Print all coefficients instead of the report: column,row,level,x,y,type,r,g,b");
  app.alias("--against", "--reference");
  app.offer_json();
}

/// A file that begins as a .haar is valid or invalid; any other is bad input.
int validate(const tool::Tool& app, const std::string& path) {
  const auto form = wavelet::file_form(path);
  tool::Report report;
  report.add("file", path);
  try {
    const wavelet::TreeSet set = wavelet::open_tree_set(path);
    report.add("form", tool::form_name(*form)).add("valid", true);
    app.print(report);
    return tool::exit_ok;
  } catch (const Error& error) {
    if (!form || error.kind() != ErrorKind::Input)
      throw;
    report.add("valid", false).add("problem", error.what());
    app.print(report);
    app.note(error.what());
    return tool::exit_no;
  }
}

std::vector<wavelet::MapPlace> chosen_trees(const Options& options, const wavelet::TreeSet& set) {
  if (options.tree.empty())
    return tool::all_trees(set);
  return {tool::chosen_map(options.tree, set.info(), "--tree")};
}

void write_image(const Options& options, const wavelet::TreeSet& set,
                 const std::vector<wavelet::MapPlace>& trees) {
  const bool single = !options.tree.empty();
  const int level = options.level.value_or(single ? set.levels() : tool::atlas_level(set));
  if (!single && tool::atlas_side(set, level) > 16384)
    throw tool::UsageError("--level: the picture would be wider than 16384 pixels");
  Image picture = single ? tool::tree_picture(set.tree(trees[0].column, trees[0].row), level)
                         : tool::atlas(set, level);
  if (tool::has_extension(options.image, ".exr"))
    return image::write_exr(options.image, picture);
  image::brighten(picture, image::middle_grey_gain(picture));
  image::write_png(options.image, picture, {.tone_map = image::ToneMap::Filmic});
}

void write_page(const Options& options, const wavelet::TreeSet& set, wavelet::FileForm form,
                const std::vector<wavelet::MapPlace>& trees,
                const std::vector<tool::TreeFigures>& figures) {
  const info::PageInput input{options.path, form, options.tree, options.level, options.reference};
  html::write_text(options.page, info::page_html(set, input, trees, figures));
}

int inspect(const tool::Tool& app, const Options& options) {
  const auto form = wavelet::file_form(options.path);
  const wavelet::TreeSet set = wavelet::open_tree_set(
      options.path, options.tree.empty() ? wavelet::Check::Everything : wavelet::Check::WhenUsed);
  if (options.level.value_or(0) > set.levels())
    throw tool::UsageError("--level: the set has levels 0 to " + std::to_string(set.levels()));
  const std::vector<wavelet::MapPlace> trees = chosen_trees(options, set);
  if (!options.image.empty())
    write_image(options, set, trees);
  const int level = options.level.value_or(set.levels());
  const bool lines = options.dump == Dump::Csv;
  const auto figures = lines && options.page.empty() ? std::vector<tool::TreeFigures>()
                                                     : tool::measure_trees(set, trees, level);
  if (!options.page.empty())
    write_page(options, set, *form, trees, figures);
  if (lines) {
    tool::dump_csv(set, trees, [&](const std::string& text) { app.print(text); });
    return tool::exit_ok;
  }
  tool::Report report = tool::describe_header(set, *form);
  tool::describe_figures(figures, set.levels(), app.json() || app.verbose(), report);
  app.print(report);
  return tool::exit_ok;
}

int run(const tool::Tool& app, const Options& options) {
  tool::check_picture_path(options.image, "--image");
  if (!options.page.empty() && options.page != standard_output &&
      !tool::has_extension(options.page, ".html"))
    throw tool::UsageError("--html: '" + options.page + "' does not end in .html");
  if (!options.reference.empty() && options.page.empty())
    throw tool::UsageError("--reference needs --html");
  if (options.path == "-" && options.reference == "-")
    throw tool::UsageError("two inputs are standard input ('-')");
  return options.validate ? validate(app, options.path) : inspect(app, options);
}

} // namespace

int main(int argc, char** argv) {
  return tool::run_program(
      argc, argv,
      tool::command("haarinfo",
                    "Reports statistics of a .haar file, validates it and draws its trees.",
                    declare, run));
}
