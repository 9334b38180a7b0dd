// haardiff: how far two sets of maps lie apart.
#include <support/compare_bounds.h>
#include <support/compare_input.h>
#include <support/compare_picture.h>
#include <support/compare_report.h>
#include <support/program.h>
#include <support/progress.h>
#include <support/words.h>

#include <wavelet/file/input_file.h>
#include <wavelet/tree/compare.h>

using namespace haarlight;
using wavelet::MapPlace;

namespace {

struct Options {
  tool::CompareInput input;
  tool::CompareBounds bounds;
  std::string image;
};

void declare(tool::Tool& app, Options& options) {
  app.input(options.input.reference, "A", "Reference: a .haar file, or a map set as EXR");
  app.input(options.input.compared, "B", "What is compared with it: likewise");
  app.values(options.input.tree, "--tree", "Only the maps of this column and row", 2, 0, 65535);
  app.values(options.input.tree_b, "--tree-b", "Column and row in B, where they are others", 2, 0,
             65535);
  tool::add_compare_bounds(app, options.bounds);
  app.optional_output(
      options.image, "--image", "OUT.png|OUT.exr",
      "Write a picture of the map that differs most, or of --tree: a .png shows A, B and B - A "
      "in false colours, an .exr holds B - A as R, G, B and the maps as A.R ... and B.R ...");
  app.offer_json();
}

/// A file's name and the indices of one of its maps.
std::string name_of(const std::string& path, const MapPlace& first, const MapPlace& place) {
  return base_name(path) + " " + std::to_string(first.column + place.column) + "," +
         std::to_string(first.row + place.row);
}

void write_image(const Options& options, const tool::ComparedSets& sets, const MapPlace& place) {
  tool::write_comparison(options.image, {sets.a->make(place.column, place.row),
                                         sets.b->make(place.column, place.row),
                                         name_of(options.input.reference, sets.first_a, place),
                                         name_of(options.input.compared, sets.first_b, place)});
}

wavelet::SetDifference compare(const tool::Tool& app, const tool::ComparedSets& sets) {
  tool::ProgressBar bar(app, "comparing maps");
  return wavelet::compare_sets(*sets.a, *sets.b, bar.callback());
}

int run(const tool::Tool& app, const Options& options) {
  tool::check_picture_path(options.image, "--image");
  const tool::ComparedSets sets = tool::open_compared(options.input);
  for (const std::string& note : sets.notes)
    app.note(note);
  const wavelet::SetDifference result = compare(app, sets);
  if (!options.image.empty())
    write_image(options, sets, result.worst);
  tool::Report report = tool::describe(result, options.input, sets);
  const std::string broken = tool::judge(result, options.bounds, report);
  app.print(report);
  if (broken.empty())
    return tool::exit_ok;
  app.note(options.input.compared + ": " + broken);
  return tool::exit_no;
}

} // namespace

int main(int argc, char** argv) {
  return tool::run_program(argc, argv, "haardiff",
                           "Tells how far two sets of maps, trees or EXR, lie apart.", declare,
                           run);
}
