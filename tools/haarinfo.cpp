// haarinfo: what a .haar file holds.
#include <support/inspect.h>
#include <support/map_choice.h>
#include <support/program.h>
#include <support/words.h>

#include <image/exposure.h>
#include <image/image_exr.h>
#include <image/png.h>

#include <wavelet/error.h>
#include <wavelet/packed_set.h>

using namespace haarlight;

namespace {

enum class Dump { None, Csv };

struct Options {
  std::string path;
  bool validate = false;
  std::vector<double> tree;
  std::optional<int> level;
  std::string image;
  Dump dump = Dump::None;
};

void declare(tool::Tool& app, Options& options) {
  app.input(options.path, "FILE.haar", "File to look into");
  app.flag(options.validate, "--validate",
           "Only check the file; exit code 1 if it breaks a rule of its format");
  app.values(options.tree, "--tree", "Only the tree of this column and row", 2, 0, 65535);
  app.value(
      options.level, "--level",
      "Level of reconstructions, 2^level pixels a side [the finest; for a picture of the whole "
      "set the finest that stays within 2048 pixels a side]",
      0, 13);
  app.text(
      options.image, "--image", "OUT.png|OUT.exr",
      "Write a picture of the tree or of the whole set; a .png is scaled to a mean of 0.18 and "
      "tone mapped, an .exr holds the values");
  app.choice(options.dump, "--dump", {{"csv", Dump::Csv}},
             "Print all differences in place of the report: column,row,level,x,y,type,r,g,b");
  app.offer_json();
}

/// A file that is a .haar by its first bytes can be valid or not; any other is bad input.
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
  image::Picture picture = single
                               ? tool::tree_picture(set.tree(trees[0].column, trees[0].row), level)
                               : tool::atlas(set, level);
  if (tool::has_extension(options.image, ".exr"))
    return image::write_exr(options.image, picture);
  image::brighten(picture, image::middle_grey_gain(picture));
  image::write_png(options.image, picture, {.tone_map = image::ToneMap::Filmic});
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
  if (options.dump == Dump::Csv) {
    tool::dump_csv(set, trees, [&](const std::string& lines) { app.print(lines); });
    return tool::exit_ok;
  }
  tool::Report report = tool::describe_header(set, *form);
  const int level = options.level.value_or(set.levels());
  tool::describe_figures(tool::measure_trees(set, trees, level), set.levels(),
                         app.json() || app.verbose(), report);
  app.print(report);
  return tool::exit_ok;
}

int look_into(const tool::Tool& app, const Options& options) {
  tool::check_picture_path(options.image, "--image");
  return options.validate ? validate(app, options.path) : inspect(app, options);
}

} // namespace

int main(int argc, char** argv) {
  return tool::run_program(argc, argv, "haarinfo",
                           "Tells what a .haar file holds, checks it and draws it.", declare,
                           look_into);
}
