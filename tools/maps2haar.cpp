// maps2haar: map sets to sparse Haar trees, and .haar files from one form to the other.
#include <support/arguments.h>
#include <support/map_output.h>
#include <support/output_size.h>
#include <support/progress.h>
#include <support/tool.h>

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
            "Map set of brdf2maps or probe2maps, or a square EXR with a power of two of pixels "
            "along a side; or, with --pack or --unpack, a .haar file");
  app.output(o.output.path, "OUT.haar", "Tree set to write");
  tool::add_compress_options(app, o.output);
  tool::add_force(app, o.output.force);
  app.flag(o.unpack, "--unpack", "Convert a packed .haar file to the mapped form");
  app.offer_json();
}

/// Packs or unpacks a .haar file; its trees stay the same.
int convert(const tool::Tool& app, const Options& o, wavelet::FileForm form) {
  const bool packed = form == wavelet::FileForm::Packed;
  if (o.unpack != packed || o.output.compression.packed == packed)
    throw_input_error(o.input, packed ? "is packed; --unpack converts it to the mapped form"
                                      : "is already a .haar file; --pack packs it");
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

int make_trees(const tool::Tool& app, Options& options) {
  const std::string& path = options.output.path;
  options.output.stream_trees = true;
  if (path != standard_output && !tool::has_extension(path, ".haar"))
    throw tool::UsageError("--output: '" + path + "' does not end in .haar");
  if (options.unpack && options.output.compression.packed)
    throw tool::UsageError("--pack and --unpack exclude each other");
  if (const auto form = wavelet::file_form(options.input)) {
    tool::refuse_threshold_options(app);
    return convert(app, options, *form);
  }
  if (options.unpack)
    throw_input_error(options.input, "is not a packed .haar file");
  const image::ExrMapSource source(options.input);
  return tool::write_map_set(app, source, options.output);
}

} // namespace

int main(int argc, char** argv) {
  return tool::run_program(
      argc, argv,
      tool::command("maps2haar",
                    "Compresses a map set to sparse Haar trees, or packs or unpacks a .haar file.",
                    declare, make_trees));
}
