#pragma once
// The main() of a program whose options are one struct.

#include <support/tool.h>

#include <string>

namespace haarlight::tool {

/// Declares the options, parses the command line and calls the body with what was given.
/// @param declare adds the options to the tool; what they hold before parsing is their default
/// @param body    called as body(tool, options), returns an exit code
/// @return the exit code
template <class Options, class Body>
int run_program(int argc, const char* const* argv, const std::string& name,
                const std::string& description, void (*declare)(Tool&, Options&), Body body) {
  Tool tool(name, description);
  Options options;
  declare(tool, options);
  return tool.run(argc, argv, [&] { return body(tool, options); });
}

} // namespace haarlight::tool
