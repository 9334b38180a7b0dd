// haardiff: the difference of two sets of maps.
#include <support/arguments.h>
#include <support/compare.h>
#include <support/progress.h>
#include <support/tool.h>

#include <wavelet/file/input_file.h>
#include <wavelet/tree/compare.h>

#include <array>
#include <optional>
#include <string>

using namespace haarlight;
using wavelet::Difference;
using wavelet::LevelDifference;
using wavelet::MapPlace;
using wavelet::SetDifference;

namespace {

struct Bounds {
  std::optional<double> l2, relative_l2, linf, mean_error; ///< at most
  std::optional<double> psnr;                              ///< at least, dB
};

constexpr double most = 1e300;

/// A bound with the value it applies to.
struct Bound {
  const char* option;
  std::optional<double> bound;
  double value;
  bool lower = false; ///< a lower bound
};

/// NaN violates every bound.
bool holds(const Bound& bound) {
  return bound.lower ? bound.value >= *bound.bound : bound.value <= *bound.bound;
}

std::string complaint(const Bound& bound) {
  const double by = bound.lower ? *bound.bound - bound.value : bound.value - *bound.bound;
  return std::string(bound.option) + " " + tool::short_text(*bound.bound) +
         " is violated: " + tool::short_text(bound.value) +
         (bound.lower ? " is too small by " : " is too large by ") + tool::short_text(by);
}

void declare_bounds(tool::Tool& app, Bounds& bounds) {
  app.value(bounds.l2, "--max-l2",
            "Bound of the root mean square difference, in the unit of the maps, colours weighted "
            "by luminance; exit code 1 if any bound is exceeded",
            0, most);
  app.value(bounds.relative_l2, "--max-relative-l2", "Bound of the same relative to the norm of A",
            0, most);
  app.value(bounds.linf, "--max-linf", "Bound of the difference of any pixel and channel", 0, most);
  app.value(bounds.psnr, "--min-psnr", "Lower bound of the peak signal-to-noise ratio, dB", -1000,
            1000);
  app.value(
      bounds.mean_error, "--max-mean-error",
      "Bound of the relative error of any map's average (the albedo, for maps with the cosine)", 0,
      most);
}

std::string check_bounds(const SetDifference& result, const Bounds& bounds, tool::Report& report) {
  const Difference& d = result.difference;
  const std::array<Bound, 5> all = {
      {{"--max-l2", bounds.l2, d.l2()},
       {"--max-relative-l2", bounds.relative_l2, d.relative_l2()},
       {"--max-linf", bounds.linf, d.largest_error},
       {"--min-psnr", bounds.psnr, d.psnr(), true},
       {"--max-mean-error", bounds.mean_error, result.worst_mean_error}}};
  std::string violated;
  for (const Bound& bound : all) {
    if (!bound.bound)
      continue;
    report.row("bounds")
        .add("option", bound.option)
        .add("bound", *bound.bound)
        .add("value", bound.value)
        .add("holds", holds(bound));
    if (!holds(bound))
      violated.append(violated.empty() ? "" : "; ").append(complaint(bound));
  }
  return violated;
}

void add_norms(const Difference& difference, tool::Report& report) {
  report.add("l2", difference.l2())
      .add("relative_l2", difference.relative_l2())
      .add("linf", difference.largest_error)
      .add("relative_linf", difference.relative_linf())
      .add("psnr", difference.psnr(), "dB");
}

/// Indices are those of A.
tool::Report& add_place(const MapPlace& place, const tool::ComparedSets& sets,
                        tool::Report& report) {
  return report.add("column", sets.first_a.column + place.column)
      .add("row", sets.first_a.row + place.row);
}

void add_places(const SetDifference& result, const tool::ComparedSets& sets, tool::Report& report) {
  add_place(result.largest, sets, report.section("largest_difference"))
      .add("x", result.x)
      .add("y", result.y)
      .add("value", result.difference.largest_error);
  tool::Report& worst = report.section("worst_map");
  add_place(result.worst, sets, worst);
  add_norms(result.worst_difference, worst);
}

template <class Level>
void add_level(const Level& name, const LevelDifference& level, double total,
               tool::Report& report) {
  report.row("levels")
      .add("level", name)
      .add("l2", level.l2())
      .add("relative_l2", level.relative_l2())
      .add("share", tool::fraction(level.difference, total));
}

void add_levels(const Difference& difference, tool::Report& report) {
  add_level("mean", difference.mean, difference.squared_error, report);
  for (std::size_t l = 0; l < difference.levels.size(); ++l)
    add_level(l, difference.levels[l], difference.squared_error, report);
}

tool::Report describe(const SetDifference& result, const tool::CompareInput& input,
                      const tool::ComparedSets& sets) {
  const wavelet::SetInfo& info = sets.a->info();
  tool::Report report;
  report.add("reference", input.reference)
      .add("compared", input.compared)
      .add("values", sets.values)
      .add("units", info.units)
      .add("map_size", info.size, "px")
      .add("columns", info.columns)
      .add("rows", info.rows)
      .add("maps", result.maps);
  add_norms(result.difference, report);
  tool::Report& integrals = report.section("integrals");
  integrals.add("mean_error", result.mean_error).add("worst_error", result.worst_mean_error);
  add_place(result.worst_mean, sets, integrals);
  add_places(result, sets, report);
  add_levels(result.difference, report);
  return report;
}

struct Options {
  tool::CompareInput input;
  Bounds bounds;
  std::string image;
};

void declare(tool::Tool& app, Options& options) {
  app.input(options.input.reference, "A", "Reference: a .haar file, or a map set as EXR");
  app.input(options.input.compared, "B", "Set to compare with it: likewise");
  app.values(options.input.tree, "--tree", "Column and row of the only maps to compare [all]", 2, 0,
             65535);
  app.values(options.input.tree_b, "--tree-b", "Column and row in B, if they differ", 2, 0, 65535);
  declare_bounds(app, options.bounds);
  app.optional_output(
      options.image, "--image", "OUT.png|OUT.exr",
      "Picture to write, of --tree or of the map that differs most: .png with A, B and B - A in "
      "false colours, .exr with B - A as R, G, B and the maps as A.R ... and B.R ...");
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
  tool::Report report = describe(result, options.input, sets);
  const std::string violated = check_bounds(result, options.bounds, report);
  app.print(report);
  if (violated.empty())
    return tool::exit_ok;
  app.note(options.input.compared + ": " + violated);
  return tool::exit_no;
}

} // namespace

int main(int argc, char** argv) {
  return tool::run_program(argc, argv,
                           tool::command("haardiff",
                                         "Compares two sets of maps, as trees or EXR: norms of the "
                                         "difference, errors of integrals, errors by level.",
                                         declare, run));
}
