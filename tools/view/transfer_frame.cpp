#include <view/transfer_frame.h>

#include <relight/session.h>
#include <view/comparison.h>
#include <view/egl_context.h>
#include <view/frame_output.h>
#include <view/transfer_drawer.h>
#include <view/transfer_light.h>
#include <view/transfer_packing.h>
#include <view/transfer_window.h>
#include <view/window_run.h>

#include <wavelet/base/error.h>
#include <wavelet/file/packed_set.h>

#include <algorithm>
#include <bit>
#include <chrono>

namespace haarlight::view {

using namespace renderer;

namespace {

int finest_level(const Transfer& transfer) {
  return std::countr_zero(static_cast<unsigned>(transfer.resolution()));
}

Change change_of(const Options& options) {
  Change change;
  change.rotate = Eigen::Map<const Eigen::Vector3d>(options.transfer.rotate.data());
  return change;
}

tool::RelightInput open_input(const tool::Tool& app, const Options& options) {
  tool::RelightInput input(app,
                           {options.input, options.transfer.scene, options.transfer.light, {}});
  if (input.variation().varying != Varying::Light)
    throw_input_error(options.input, "lets " + input.transfer().varying_text() +
                                         " vary; this takes one built with --vary light");
  return input;
}

/// What haarrelight apply makes, unless a picture is named; nothing if there is no comparison.
std::vector<float> reference_of(const tool::RelightInput& input, const Options& options) {
  const Transfer& transfer = input.transfer();
  if (!options.reference.empty())
    return read_reference(options.reference, transfer.width(), transfer.height());
  if (!options.compare)
    return {};
  return light_relighter(transfer, input.scene())->make(change_of(options)).rgb;
}

/// Median time that it takes to turn the light and to hand it to GL, ms.
double turn(const TransferLight& light, const Eigen::Matrix3f& by, int repeat,
            TransferDrawer& drawer) {
  const Drawing turning = {[&](int) {
                             const auto begin = std::chrono::steady_clock::now();
                             drawer.set_light(light.turned(by));
                             const std::chrono::duration<double, std::milli> passed =
                                 std::chrono::steady_clock::now() - begin;
                             return passed.count();
                           },
                           {},
                           repeat};
  return turning.time(0);
}

void draw_frame(const tool::RelightInput& input, const Options& options, tool::Report& report) {
  const Transfer& transfer = input.transfer();
  const std::vector<float> reference = reference_of(input, options);
  const std::vector<FilmPoint> points =
      film_points(input.scene(), transfer.width(), transfer.height());
  const TransferLight light(transfer, input.scene(), points);
  const EglContext context;
  TransferDrawer drawer(
      pack_transfer(transfer.trees(), points, transfer.width(), transfer.height()),
      transfer.width(), transfer.height());
  const double ms_per_turn =
      turn(light, rotation_of(change_of(options).rotate), options.repeat, drawer);
  const int finest = finest_level(transfer);
  const int level = options.level.value_or(finest);
  const Drawing drawing = {[&](int l) { return drawer.draw(l); }, [&] { return drawer.read(); },
                           options.repeat};
  drawing.draw(level); // compiles the shaders as well
  const DrawnFrame frame = drawing.read();
  write_frame(options, frame, transfer.width(), transfer.height());
  report.add("renderer", context.renderer())
      .add("texture_bytes", drawer.texture_bytes())
      .add("accesses_per_pixel", frame.accesses)
      .add("ms_per_turn", ms_per_turn, "ms")
      .add("ms_per_frame", drawing.time(level), "ms");
  if (!reference.empty())
    add_comparison(drawing, level, finest, reference, report);
}

int view_in_window(const tool::Tool& app, const tool::RelightInput& input, const Options& options) {
  TransferWindowInput shown;
  for (std::size_t i = 0; i < 3; ++i)
    shown.look.rotate[i] = static_cast<float>(options.transfer.rotate[i]);
  const int finest = finest_level(input.transfer());
  shown.look.level = std::min(options.level.value_or(finest), finest);
  shown.look.exposure = static_cast<float>(options.exposure);
  shown.bare = options.window.input.bare;
  shown.script = options.window.input.script;
  shown.script.screenshot = !options.window.screenshot.empty();
  return report_window(app, options, show_transfer(input.transfer(), input.scene(), shown));
}

} // namespace

bool is_transfer(const std::string& path) {
  const auto form = wavelet::file_form(path);
  if (!form)
    return false;
  const wavelet::TreeSet set = wavelet::open_tree_set(path, wavelet::Check::WhenUsed);
  return set.info().provenance.get("transfer") == "1";
}

int view_transfer(const tool::Tool& app, const Options& options) {
  check_transfer(app);
  const tool::RelightInput input = open_input(app, options);
  if (shows_window(options))
    return view_in_window(app, input, options);
  tool::Report report;
  report.add("width", input.transfer().width(), "px")
      .add("height", input.transfer().height(), "px")
      .add("level", options.level ? std::to_string(*options.level) : std::string("all"))
      .add("trees", input.transfer().trees().size());
  draw_frame(input, options, report);
  app.print(report);
  return tool::exit_ok;
}

} // namespace haarlight::view
