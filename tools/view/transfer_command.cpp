#include <view/commands.h>
#include <view/comparison.h>
#include <view/transfer.h>

#include <relight/session.h>

#include <wavelet/base/error.h>

#include <algorithm>
#include <bit>
#include <chrono>

namespace haarlight::view {
namespace {

using renderer::Transfer;

int finest_level(const Transfer& transfer) {
  return std::countr_zero(static_cast<unsigned>(transfer.resolution()));
}

Eigen::Vector3d rotation_angles(const Options& options) {
  return Eigen::Map<const Eigen::Vector3d>(options.rotate.data());
}

tool::RelightInput open_input(const tool::Tool& app, const Options& options) {
  tool::RelightInput input(app, {options.input, options.transfer_scene, options.probe, {}});
  if (input.variation().varying != renderer::Varying::Light)
    throw_input_error(options.input, "was built with --vary " + input.transfer().varying_text() +
                                         "; expected --vary light");
  return input;
}

/// The reference picture, by default what haarrelight apply makes; empty if there is no comparison.
std::vector<float> reference_frame(const tool::RelightInput& input, const Options& options) {
  const Transfer& transfer = input.transfer();
  if (!options.reference.empty())
    return read_reference(options.reference, transfer.width(), transfer.height());
  if (!options.compare)
    return {};
  renderer::Change change;
  change.rotate = rotation_angles(options);
  return light_relighter(transfer, input.scene())->make(change).rgb;
}

void draw_frame(const tool::RelightInput& input, const Options& options, tool::Report& report) {
  const Transfer& transfer = input.transfer();
  const int width = transfer.width();
  const int height = transfer.height();
  const std::vector<float> reference = reference_frame(input, options);
  const std::vector<renderer::FilmPoint> points = film_points(input.scene(), width, height);
  const TransferLight light(transfer, input.scene(), points);
  const EglContext context;
  TransferDrawer drawer(pack_transfer(transfer.trees(), points, width, height), width, height);
  const Eigen::Matrix3f rotation = renderer::rotation_of(rotation_angles(options));
  const double ms_per_turn = median_time(options.repeat, [&] {
    const auto begin = std::chrono::steady_clock::now();
    drawer.set_light(light.rotated(rotation));
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin)
        .count();
  });
  const int finest = finest_level(transfer);
  const FrameTest test = {drawer, [&](int level) { return drawer.draw(level); },
                          options.level.value_or(finest), options.repeat};
  const DrawnFrame frame = test.write(options.frame, width, height, options.exposure);
  report.add("renderer", renderer_name())
      .add("texture_bytes", drawer.texture_bytes())
      .add("accesses_per_pixel", frame.accesses)
      .add("ms_per_turn", ms_per_turn, "ms")
      .add("ms_per_frame", test.time(), "ms");
  if (!reference.empty())
    test.compare(reference, finest, report);
}

TransferWindowInput window_input(const Transfer& transfer, const Options& options) {
  TransferWindowInput input;
  std::transform(options.rotate.begin(), options.rotate.end(), input.state.rotate.begin(),
                 [](double angle) { return static_cast<float>(angle); });
  const int finest = finest_level(transfer);
  input.state.level = std::min(options.level.value_or(finest), finest);
  input.state.exposure = static_cast<float>(options.exposure);
  input.panel = !options.no_panel;
  input.script = options.script;
  return input;
}

} // namespace

int view_transfer(const tool::Tool& app, const Options& options) {
  const tool::RelightInput input = open_input(app, options);
  const Transfer& transfer = input.transfer();
  if (options.shows_window())
    return report_window(app, options,
                         show_transfer(transfer, input.scene(), window_input(transfer, options)));
  tool::Report report;
  report.add("width", transfer.width(), "px")
      .add("height", transfer.height(), "px")
      .add("level", options.level ? std::to_string(*options.level) : std::string("all"))
      .add("trees", transfer.trees().size());
  draw_frame(input, options, report);
  app.print(report);
  return tool::exit_ok;
}

} // namespace haarlight::view
