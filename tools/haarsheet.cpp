// haarsheet: pictures side by side, compared with a reference.
#include <support/arguments.h>
#include <support/report.h>
#include <support/tool.h>

#include <image/contact_sheet.h>
#include <image/image_exr.h>
#include <image/png.h>

#include <wavelet/base/error.h>
#include <wavelet/file/input_file.h>

#include <cmath>
#include <numeric>

using namespace haarlight;

namespace {

struct Options {
  std::vector<std::string> paths;
  std::vector<std::string> captions;
  std::string reference;
  std::string output;
  image::PngOptions tone;
  image::SheetOptions sheet;
};

void declare(tool::Tool& app, Options& options) {
  app.inputs(options.paths, "PICTURES", "Pictures: EXR (R, G, B, one layer of these, or Y) or PNG");
  app.output(options.output, "OUT.png", "Contact sheet to write");
  app.texts(options.captions, "--caption", "TEXT",
            "Caption of a picture; one option per picture, in their order [the file names]");
  app.optional_input(options.reference, "--reference", "IN.exr",
                     "Reference picture: report each picture's root mean square relative error, "
                     "and add it to its caption");
  app.value(options.sheet.columns, "--columns", "Pictures per row; 0 = nearly square", 0, 1000);
  app.value(options.sheet.scale, "--font-scale", "Magnification of the font", 1, 16);
  app.value(options.tone.exposure, "--exposure", "Exposure of EXR pictures, stops", -50, 50);
  app.choice(options.tone.tone_map, "--tone-map",
             {{"clamp", image::ToneMap::Clamp}, {"filmic", image::ToneMap::Filmic}},
             "Tone mapping of EXR pictures");
  app.offer_json();
}

Image read(const std::string& path) {
  return tool::has_extension(path, ".png") ? image::read_png(path) : image::read_exr(path);
}

/// Root mean square of the relative error over all channels and pixels; the error is relative to at
/// least 1 % of the reference's mean.
double relative_error(const Image& picture, const Image& reference, const std::string& path) {
  if (picture.width != reference.width || picture.height != reference.height)
    throw_input_error(path, "does not have the size of the reference, " +
                                std::to_string(reference.width) + " x " +
                                std::to_string(reference.height) + " pixels");
  const auto count = static_cast<double>(reference.rgb.size());
  const double mean = std::accumulate(reference.rgb.begin(), reference.rgb.end(), 0.0) / count;
  double sum = 0;
  for (std::size_t i = 0; i < picture.rgb.size(); ++i) {
    const auto wanted = static_cast<double>(reference.rgb[i]);
    const double error = static_cast<double>(picture.rgb[i]) - wanted;
    sum += error == 0 ? 0 : error * error / (wanted * wanted + 1e-4 * mean * mean);
  }
  return std::sqrt(sum / count);
}

std::string caption_of(const Options& options, std::size_t i) {
  return options.captions.empty() ? base_name(options.paths[i]) : options.captions[i];
}

int make_sheet(const tool::Tool& app, const Options& options) {
  if (!options.captions.empty() && options.captions.size() != options.paths.size())
    throw tool::UsageError("--caption: one option per picture is needed");
  const bool compare = !options.reference.empty();
  const Image reference = compare ? read(options.reference) : Image();
  tool::Report report;
  std::vector<image::SheetEntry> entries;
  for (std::size_t i = 0; i < options.paths.size(); ++i) {
    const std::string& path = options.paths[i];
    image::SheetEntry entry{read(path), caption_of(options, i)};
    tool::Report& row = report.row("pictures").add("picture", entry.caption);
    if (compare) {
      const double error = relative_error(entry.picture, reference, path);
      row.add("relative_error", error);
      entry.caption += " ERROR " + tool::short_text(std::round(error * 1e4) / 1e4);
    }
    if (!tool::has_extension(path, ".png"))
      image::tone_map(entry.picture, options.tone);
    entries.push_back(std::move(entry));
  }
  image::write_png(options.output, image::contact_sheet(entries, options.sheet));
  app.print(report);
  return tool::exit_ok;
}

} // namespace

int main(int argc, char** argv) {
  return tool::run_program(
      argc, argv,
      tool::command(
          "haarsheet",
          "Arranges pictures side by side on a contact sheet and compares them with a reference.",
          declare, make_sheet));
}
