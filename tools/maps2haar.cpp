// maps2haar: a map set to sparse Haar trees, and .haar files from one form to the other.
#include <support/map_output.h>
#include <support/output_size.h>
#include <support/progress.h>
#include <support/tool.h>
#include <support/words.h>

#include <image/map_set_exr.h>

#include <wavelet/base/error.h>
#include <wavelet/file/tree_set.h>

using namespace haarlight;

namespace {

struct Options {
  std::string input;
  bool unpack = false;
  tool::MapOutput output;
};

void declare(tool::Tool& app, Options& o) {
  app.input(o.input, "IN.exr|IN.haar",
            "Map set of brdf2maps or probe2maps, or a square EXR of a power of two of pixels a "
            "side; or, with --pack or --unpack, a .haar file");
  app.output(o.output.path, "OUT.haar", "Trees to write");
  tool::add_compress_options(app, o.output);
  tool::add_force(app, o.output.force);
  app.flag(o.unpack, "--unpack", "Give a packed .haar file its mapped form back");
  app.offer_json();
}

/// The input is a .haar file, and stays what it is but for its form.
int convert(const tool::Tool& app, const Options& o, wavelet::FileForm form) {
  const bool packed = form == wavelet::FileForm::Packed;
  if (o.unpack != packed || o.output.compression.packed == packed)
    throw_input_error(o.input, packed ? "is packed; --unpack gives it its mapped form back"
                                      : "is a .haar file already; --pack packs it");
  OutputFile file(o.output.path);
  {
    tool::ProgressBar bar(app, packed ? "unpacking" : "packing");
    (packed ? wavelet::unpack : wavelet::pack)(o.input, file, bar.callback());
  }
  const std::uint64_t bytes = file.position();
  file.commit();
  tool::Report report;
  report.add("source", base_name(o.input))
      .add("source_bytes", static_cast<std::uint64_t>(InputFile(o.input).size()))
      .add("form", packed ? "mapped" : "packed")
      .add("bytes", bytes)
      .add("output", o.output.path);
  app.print(report);
  return tool::exit_ok;
}

} // namespace

int main(int argc, char** argv) {
  tool::Tool app("maps2haar", "Compresses a map set into sparse Haar trees, and packs and unpacks "
                              "files of them.");
  Options options;
  declare(app, options);
  return app.run(argc, argv, [&] {
    const std::string& path = options.output.path;
    options.output.stream_trees = true;
    if (path != standard_output && !tool::has_extension(path, ".haar"))
      throw tool::UsageError("--output: '" + path + "' does not end in .haar");
    if (options.unpack && options.output.compression.packed)
      throw tool::UsageError("--pack and --unpack exclude each other");
    const auto form = wavelet::file_form(options.input);
    if (form) {
      tool::refuse_threshold_options(app);
      return convert(app, options, *form);
    }
    if (options.unpack)
      throw_input_error(options.input, "is no packed .haar file");
    const image::ExrMapSource source(options.input);
    return tool::write_map_set(app, source, options.output);
  });
}
