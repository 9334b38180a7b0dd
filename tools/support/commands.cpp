#include <support/commands.h>

#include <algorithm>

namespace haarlight::tool {
namespace {

std::string names_of(const std::vector<Command>& commands) {
  std::string list;
  for (const Command& command : commands)
    list.append(list.empty() ? "" : "|").append(command.name);
  return list;
}

std::string help_of(const std::vector<Command>& commands, const std::string& name) {
  std::string text = "One of these; `" + name + " COMMAND --help` tells of its options.";
  for (const Command& command : commands)
    text.append(" ").append(command.name).append(": ").append(command.summary);
  return text;
}

} // namespace

int run_commands(int argc, const char* const* argv, const std::string& name,
                 const std::string& description, const std::vector<Command>& commands) {
  const std::string word = argc > 1 ? argv[1] : "";
  const auto found = std::find_if(commands.begin(), commands.end(),
                                  [&](const Command& command) { return command.name == word; });
  if (found != commands.end())
    return found->run(argc - 1, argv + 1);
  Tool tool(name, description);
  std::string unknown;
  tool.input(unknown, "COMMAND", help_of(commands, name));
  return tool.run(argc, argv, [&]() -> int {
    throw UsageError("'" + unknown + "' is none of " + names_of(commands));
  });
}

} // namespace haarlight::tool
