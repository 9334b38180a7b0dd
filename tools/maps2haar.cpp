// maps2haar: a map set to sparse Haar trees.
#include <support/map_output.h>
#include <support/tool.h>
#include <support/words.h>

#include <image/map_set_exr.h>

using namespace haarlight;

int main(int argc, char** argv) {
  tool::Tool app("maps2haar", "Compresses a map set into sparse Haar trees.");
  std::string input;
  tool::MapOutput output;
  app.input(
      input, "IN.exr",
      "Map set of brdf2maps or probe2maps, or a square EXR of a power of two of pixels a side");
  app.output(output.path, "OUT.haar", "Trees to write");
  tool::add_compress_options(app, output);
  app.offer_json();
  return app.run(argc, argv, [&] {
    if (!tool::has_extension(output.path, ".haar"))
      throw tool::UsageError("--output: '" + output.path + "' does not end in .haar");
    const image::ExrMapSource source(input);
    return tool::write_map_set(app, source, output);
  });
}
