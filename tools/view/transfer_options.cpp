#include <view/transfer_options.h>

#include <initializer_list>

namespace haarlight::view {
namespace {

void refuse(const tool::Tool& app, std::initializer_list<const char*> names, const char* why) {
  for (const char* name : names)
    if (app.given(name))
      throw tool::UsageError(std::string(name) + ": " + why);
}

} // namespace

void declare_transfer(tool::Tool& app, TransferOptions& options) {
  app.values(options.rotate, "--rotate",
             "Of transfer: yaw, pitch, roll in degrees that the light is turned by, as haarrelight "
             "apply has it",
             3, -1e6, 1e6);
  app.optional_input(
      options.light, "--light", "PROBE",
      "Of transfer: another light, any probe image, or a .haar of one world-frame map [the "
      "scene's]");
  app.optional_input(options.scene, "--scene", "SCENE.json",
                     "Of transfer: the scene it was made of [the file of that name beside it]");
}

void check_transfer(const tool::Tool& app) {
  refuse(app,
         {"--size", "--light-direction", "--light-position", "--irradiance", "--environment",
          "--probe", "--light-level", "--tolerance", "--export", "--against", "--material",
          "--watch", "--reloads"},
         "transfer takes no such option; --rotate and --light change its light");
}

void check_scene(const tool::Tool& app) {
  refuse(app, {"--rotate", "--light", "--scene"},
         "is of transfer, which haarrelight build makes with --vary light");
}

} // namespace haarlight::view
