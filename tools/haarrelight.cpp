// haarrelight: pictures that follow at once when one factor of their integrals is moved.
#include <relight/commands.h>

int main(int argc, char** argv) {
  using namespace haarlight::tool;
  return run_commands(argc, argv, "haarrelight",
                      "Keeps all factors of a picture's integrals but one as trees, and makes the "
                      "picture anew as that one is moved.",
                      {build_command(), apply_command(), sweep_command()});
}
