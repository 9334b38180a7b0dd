// probe2maps: a light probe to one map in the world's frame, or to a table of rotated ones.
#include <support/map_output.h>
#include <support/tool.h>

#include <probe/probe_maps.h>
#include <probe/read_probe.h>
#include <wavelet/base/memory.h>

#include <bit>

using namespace haarlight;

namespace {

/// Nothing stands for `auto`.
using MappingChoice = std::optional<probe::Mapping>;

struct Options {
  std::string input;
  MappingChoice mapping;
  probe::ImageChoice image;
  probe::MapOptions maps;
  tool::MapOutput output;
};

void declare(tool::Tool& app, Options& o) {
  app.input(o.input, "IN",
            "Light probe: Radiance RGBE, OpenEXR, PFM, TIFF, PNG or JPEG, recognised by content");
  tool::add_map_output(app, o.output);
  app.value(o.maps.size, "--size",
            "Pixels along a side of each map, a power of two from 4; 0 = from 512 to 2048 as the "
            "probe's resolution requires, or 128 with --orientations",
            0, 8192);
  app.value(o.maps.orientations, "--orientations",
            "M: 1 = one map in the world frame, else maps for M x M mirror directions", 1, 1024);
  app.value(o.maps.supersample, "--supersample",
            "Minimum number of samples along a side of a pixel; small pixels of the probe get more",
            1, 64);
  app.choice(o.mapping, "--mapping",
             {{"auto", MappingChoice()},
              {"angular", probe::Mapping::Angular},
              {"latlong", probe::Mapping::LatLong},
              {"mirrorball", probe::Mapping::MirrorBall},
              {"octahedral", probe::Mapping::Octahedral}},
             "Mapping of directions to pixels; auto = by aspect ratio and content");
  app.text(o.image.layer, "--layer", "NAME",
           "Layer of an OpenEXR file: the channels NAME.R, NAME.G, NAME.B or NAME.Y [R, G, B "
           "without a layer, else the only layer with these, else Y]");
  app.text(
      o.image.part, "--part", "N|NAME",
      "Part of an OpenEXR file by name or number from 0; page of a TIFF file by number from 0");
}

void check(const probe::MapOptions& maps) {
  const bool power_of_two = std::has_single_bit(static_cast<unsigned>(maps.size));
  if (maps.size != 0 && (!power_of_two || maps.size < 4))
    throw tool::UsageError("--size must be a power of two from 4, or 0");
}

/// For errors of memory.
std::string maps_text(int size) {
  const std::string side = std::to_string(size);
  return size == 0 ? "maps of the probe" : "a map of " + side + " x " + side + " pixels";
}

/// 0 = unknown.
std::uint64_t map_bytes(int size) {
  return 3 * sizeof(float) * static_cast<std::uint64_t>(size) * static_cast<std::uint64_t>(size);
}

int make_maps(const tool::Tool& app, const Options& options) {
  check(options.maps);
  const probe::LoadedProbe loaded = with_memory_for("the pixels of " + options.input, 0, [&] {
    return probe::read_probe(options.input, options.mapping, probe::Lookup::Nearest, options.image);
  });
  app.note(options.input + ": " + loaded.mapping_reason);
  for (const std::string& note : loaded.notes)
    app.note(options.input + ": " + note);
  tool::Report report;
  report.add("source", loaded.source.get("source"))
      .add("mapping", probe::mapping_name(loaded.probe.mapping()));
  const auto maps =
      with_memory_for(maps_text(options.maps.size), map_bytes(options.maps.size),
                      [&] { return probe::ProbeMaps(loaded.probe, options.maps, loaded.source); });
  return tool::write_map_set(app, maps, options.output, report);
}

} // namespace

int main(int argc, char** argv) {
  return tool::run_program(
      argc, argv,
      tool::command("probe2maps",
                    "Resamples a light probe into square maps of radiance (in the unit of the "
                    "probe) over the sphere by the equal-area octahedral mapping.",
                    declare, make_maps));
}
