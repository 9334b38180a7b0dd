// brdf2maps: a measured BRDF to a set of maps in the reflection frame.
#include <support/map_output.h>
#include <support/report.h>
#include <support/tool.h>

#include <brdf/brdf_maps.h>
#include <brdf/brdf_properties.h>
#include <wavelet/base/memory.h>

#include <array>

using namespace haarlight;

namespace {

enum class FoldChoice { Auto, None, Rotations, Mirrors };

struct Options {
  std::string input;
  brdf::BrdfMapOptions maps;
  brdf::Lookup lookup = brdf::Lookup::Trilinear;
  FoldChoice fold = FoldChoice::Auto;
  bool no_cosine = false;
  tool::MapOutput output;
};

void declare(tool::Tool& app, Options& o) {
  app.input(o.input, "IN.binary", "MERL file, 90 x 90 x 180 or 90 x 90 x 360 bins");
  tool::add_map_output(app, o.output);
  app.value(o.maps.size, "--size",
            "Pixels along a side of each map, a power of two; 0 = 512, or 128 with --roll", 0,
            8192);
  app.value(o.maps.theta, "--theta", "Number of cells of theta_r, over 90 degrees", 1, 4096);
  app.value(o.maps.roll, "--roll",
            "Number of cells of the roll phi, over 360 degrees; 1 = theta_r only", 1, 4096);
  app.value(
      o.maps.supersample, "--supersample",
      "Minimum number of samples along a side of a pixel; lobes narrower than a pixel get more", 1,
      64);
  app.flag(o.no_cosine, "--no-cosine", "Omit the factor max(0, cos): maps of f_r");
  app.choice(o.lookup, "--lookup",
             {{"trilinear", brdf::Lookup::Trilinear}, {"nearest", brdf::Lookup::Nearest}},
             "Interpolation of the file's cells");
  app.choice(o.fold, "--fold",
             {{"auto", FoldChoice::Auto},
              {"none", FoldChoice::None},
              {"rotations", FoldChoice::Rotations},
              {"mirrors", FoldChoice::Mirrors}},
             "Symmetry by which rolls are omitted; auto = rotations if the number of rolls is a "
             "multiple of 4, else none; mirrors averages the file with its mirror image");
}

brdf::BrdfMapOptions map_options(const Options& o) {
  brdf::BrdfMapOptions maps = o.maps;
  maps.cosine = !o.no_cosine;
  if (o.fold == FoldChoice::None)
    maps.fold = wavelet::Fold::None;
  if (o.fold == FoldChoice::Rotations)
    maps.fold = wavelet::Fold::Rotations;
  if (o.fold == FoldChoice::Mirrors)
    maps.fold = wavelet::Fold::Mirrors;
  if (const auto problem = brdf::validate(maps))
    throw tool::UsageError(*problem);
  return maps;
}

/// Why a table has no valid cell.
std::string emptiness(const brdf::MeasuredBrdf& table) {
  std::string channels;
  for (std::size_t c = 0; c < 3; ++c)
    if (table.negative_fractions()[c] == 1)
      channels += std::string(channels.empty() ? "" : ", ") + std::array{"red", "green", "blue"}[c];
  return channels.empty() ? "every cell is negative in some channel"
                          : "every cell is negative in " + channels;
}

/// Notes an albedo above 1, which no passive surface has.
void note_albedo(const tool::Tool& app, const Options& options, const brdf::BrdfMaps& maps) {
  float largest = 1;
  int column = -1;
  for (int c = 0; c < maps.info().columns; ++c) {
    const float albedo = maps.integral(c, 0)->maxCoeff();
    if (albedo > largest) {
      largest = albedo;
      column = c;
    }
  }
  if (column < 0)
    return;
  const double degrees = (column + 0.5) * 90 / maps.info().columns;
  app.note(options.input + ": the albedo is above 1, up to " +
           tool::short_text(static_cast<double>(largest)) +
           " at theta_r = " + tool::short_text(degrees) + " degrees");
}

int make_maps(const tool::Tool& app, const Options& options) {
  const brdf::BrdfMapOptions map_settings = map_options(options);
  auto table = with_memory_for("the cells of " + options.input, 0,
                               [&] { return brdf::MeasuredBrdf(options.input, options.lookup); });
  tool::Report report;
  report.add("source", table.name()).add("invalid_cells", table.invalid_fraction());
  if (table.invalid_fraction() == 1) {
    app.print(report);
    app.note(options.input + ": not written: no cell is valid, " + emptiness(table));
    return tool::exit_no;
  }
  report.add("bilateral_asymmetry", brdf::bilateral_asymmetry(table));
  const brdf::BrdfMaps maps(std::move(table), map_settings);
  const int code = tool::write_map_set(app, maps, options.output, report);
  if (map_settings.cosine)
    note_albedo(app, options, maps);
  return code;
}

} // namespace

int main(int argc, char** argv) {
  return tool::run_program(
      argc, argv,
      tool::command(
          "brdf2maps",
          "Resamples a measured BRDF into maps of f_r cos (1/sr) over the sphere, in frames about "
          "the mirror direction: one map per cell of the normal's angle theta_r and roll phi.",
          declare, make_maps));
}
