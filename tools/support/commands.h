#pragma once
// The main() of a program of several commands, each with options of its own: `haarx COMMAND …`.

#include <support/program.h>

#include <functional>
#include <string>
#include <vector>

namespace haarlight::tool {

/// One command: its name, what it does, and its own run_program(), which is given the command line
/// without the program's name.
struct Command {
  std::string name;
  std::string summary;
  std::function<int(int argc, const char* const* argv)> run;
};

/// A command whose options are one struct, as run_program() takes them. Its errors and its --help
/// speak as `program command`.
template <class Options, class Body>
Command command(const std::string& program, const std::string& name, const std::string& summary,
                void (*declare)(Tool&, Options&), Body body) {
  return {name, summary, [=](int argc, const char* const* argv) {
            return run_program(argc, argv, program + " " + name, summary, declare, body);
          }};
}

/// Hands over to the command named first. Without one: --help lists them, --version, or exit code
/// 2.
int run_commands(int argc, const char* const* argv, const std::string& name,
                 const std::string& description, const std::vector<Command>& commands);

} // namespace haarlight::tool
