#include <view/comparison.h>

#include <image/image_exr.h>
#include <view/cpu_frame.h>
#include <wavelet/base/error.h>

#include <algorithm>
#include <utility>

namespace haarlight::view {

double Drawing::time(int level) const {
  std::vector<double> times;
  times.reserve(static_cast<std::size_t>(repeat));
  for (int i = 0; i < repeat; ++i)
    times.push_back(draw(level));
  std::nth_element(times.begin(), times.begin() + repeat / 2, times.end());
  return times[static_cast<std::size_t>(repeat / 2)];
}

std::vector<float> read_reference(const std::string& path, int width, int height) {
  Image reference = image::read_exr(path);
  if (reference.width != width || reference.height != height)
    throw_input_error(path, "is " + std::to_string(reference.width) + "x" +
                                std::to_string(reference.height) +
                                " pixels large, unlike the frame");
  return std::move(reference.rgb);
}

std::vector<float> reference_of(const ViewScene& scene, const renderer::SceneDescription& film,
                                const Options& options) {
  if (options.reference.empty() && !options.compare)
    return {};
  if (options.reference.empty())
    return lighting_of(options) == Lighting::Lamp
               ? cpu_frame(scene, lamp_of(options), film.width, film.height)
               : cpu_environment_frame(film, film.width, film.height);
  return read_reference(options.reference, film.width, film.height);
}

void add_comparison(const Drawing& drawing, int level, int finest,
                    const std::vector<float>& reference, tool::Report& report) {
  drawing.draw(level);
  report.add("relative_rms", relative_rms(drawing.read().rgb, reference));
  for (int coarse = 0; coarse <= finest; ++coarse) {
    const double ms = drawing.time(coarse);
    const DrawnFrame frame = drawing.read();
    report.row("levels")
        .add("level", coarse)
        .add("relative_rms", relative_rms(frame.rgb, reference))
        .add("accesses", frame.accesses)
        .add("ms_per_frame", ms);
  }
}

int finest_level(const ViewScene& scene, const Options& options) {
  return lighting_of(options) == Lighting::Lamp ? scene.levels() : light_level_of(options);
}

} // namespace haarlight::view
