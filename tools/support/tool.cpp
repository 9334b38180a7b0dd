// Declaration and parsing of options, and which files a run reads and writes.
#include <support/tool.h>

#include <support/arguments.h>

#include <wavelet/file/output_file.h>
#include <wavelet/file/provenance.h>

#include <CLI/CLI.hpp>

#include <algorithm>
#include <map>

#include <sys/stat.h>
#include <unistd.h>

namespace haarlight::tool {
namespace {

constexpr const char* standard_input = "-";
constexpr int any_number = 1 << 20; ///< of words in a list

std::string version_line(const std::string& name) {
  std::string version = version_text(); // "haarlight 0.1.0"
  return name + " (" + version.insert(version.find(' '), ")");
}

/// Of names as in "-o,--output".
std::string long_name(const std::string& names) { return names.substr(names.find("--")); }

std::string with_default(const std::string& help, const std::string& shown_default) {
  return shown_default.empty() ? help : help + " [" + shown_default + "]";
}

template <class Number>
std::string list_text(const std::vector<Number>& numbers) {
  std::string text;
  for (const Number number : numbers)
    text.append(text.empty() ? "" : ",").append(short_text(static_cast<double>(number)));
  return text;
}

std::string joined(const std::vector<std::string>& words, const char* separator) {
  std::string text;
  for (const std::string& word : words)
    text.append(text.empty() ? "" : separator).append(word);
  return text;
}

/// A required path: CLI11 itself accepts an empty one.
void set_path(std::string& path, const std::string& word) {
  if (word.empty())
    throw CLI::ValidationError("a path is empty");
  path = word;
}

std::size_t index_of(const std::string& word, const std::vector<std::string>& words,
                     const std::string& shown) {
  const auto place = std::find(words.begin(), words.end(), word);
  if (place == words.end())
    throw UsageError("'" + word + "' is none of " + shown);
  return static_cast<std::size_t>(place - words.begin());
}

std::string inode_text(const struct stat& status) {
  return std::to_string(status.st_dev) + ":" + std::to_string(status.st_ino);
}

/// An output that does not exist yet is identified by its folder and name.
std::string output_identity(const std::string& path) {
  struct stat status = {};
  if (path == standard_output)
    return ::fstat(STDOUT_FILENO, &status) == 0 && S_ISREG(status.st_mode) ? inode_text(status)
                                                                           : path;
  if (::stat(path.c_str(), &status) == 0)
    return inode_text(status);
  std::string target = link_target(path);
  const std::size_t slash = target.rfind('/');
  const std::string folder = slash == std::string::npos ? "./" : target.substr(0, slash + 1);
  if (::stat(folder.c_str(), &status) != 0)
    return target;
  return inode_text(status) + "/" + target.substr(slash == std::string::npos ? 0 : slash + 1);
}

} // namespace

/// The files of a run: no output may be another file of the same run, however they are spelled or
/// linked. Inputs may be named twice, except standard input, which is read once.
class FileRoles {
public:
  void add_output(const std::string& role, const std::string& path) {
    m_standard_output = m_standard_output || path == standard_output;
    add(output_identity(path), path, {role, true});
  }

  void add_input(const std::string& role, const std::string& path) {
    if (path == standard_input || path == "/dev/stdin") {
      if (!m_standard_input.empty())
        throw UsageError(role + ": '" + path +
                         "' is standard input, which is read once, already as " + m_standard_input);
      m_standard_input = role;
      return;
    }
    struct stat status = {};
    if (::stat(path.c_str(), &status) == 0) // its reader reports a missing input
      add(inode_text(status), path, {role, false});
  }

  bool writes_standard_output() const { return m_standard_output; }

private:
  struct Role {
    std::string name;
    bool output;
  };

  void add(const std::string& identity, const std::string& path, const Role& role) {
    const auto [place, is_new] = m_roles.emplace(identity, role);
    if (is_new || (!role.output && !place->second.output))
      return;
    const bool two_outputs = role.output && place->second.output;
    const std::string& output = role.output ? role.name : place->second.name;
    const std::string& other = role.output ? place->second.name : role.name;
    throw UsageError(output + ": '" + path + "' is the same file as " +
                     (two_outputs ? "the output " : "the input ") + other);
  }

  std::map<std::string, Role> m_roles; ///< by identity
  std::string m_standard_input;        ///< role of the input that is "-"
  bool m_standard_output = false;
};

struct Tool::Parser {
  CLI::App app;
  std::map<std::string, std::string> aliases;     ///< option by old spelling
  std::vector<std::function<void()>> file_checks; ///< of declared files
  FileRoles files;

  /// The arguments with present spellings, last first, as CLI11 takes them.
  std::vector<std::string> arguments(int argc, const char* const* argv) const {
    std::vector<std::string> words(argv + 1, argv + argc);
    for (std::string& word : words) {
      if (word == "--")
        break;
      const std::size_t end = std::min(word.find('='), word.size());
      if (const auto found = aliases.find(word.substr(0, end)); found != aliases.end())
        word.replace(0, end, found->second);
    }
    std::reverse(words.begin(), words.end());
    return words;
  }
};

Tool::Tool(const std::string& name, const std::string& description)
    : m_name(name.substr(0, name.find(' '))), m_usage(name), m_parser(std::make_unique<Parser>()) {
  m_parser->app.name(m_usage);
  m_parser->app.description(m_usage + ": " + description);
  m_parser->app.set_help_flag("-h,--help", "Print this help and exit");
  m_parser->app.set_version_flag("--version", version_line(m_name), "Print the version and exit");
  flag(m_quiet, "-q,--quiet", "Print no notes and no progress to stderr");
  flag(m_verbose, "-v,--verbose", "Print more notes to stderr");
  value(m_threads, "--threads", "Number of threads; 0 = one per available core", 0, 4096);
}

Tool::~Tool() = default;

void Tool::input(std::string& path, const std::string& placeholder, const std::string& help) {
  m_parser->app
      .add_option_function<std::string>(
          placeholder, [&path](const std::string& word) { set_path(path, word); }, help)
      ->type_name("")
      ->required();
  m_parser->file_checks.emplace_back([this, &path, placeholder] { reads(placeholder, path); });
}

void Tool::inputs(std::vector<std::string>& paths, const std::string& placeholder,
                  const std::string& help) {
  m_parser->app.add_option(placeholder, paths, help)->type_name("")->required();
  m_parser->file_checks.emplace_back([this, &paths, placeholder] {
    for (const std::string& path : paths)
      reads(placeholder, path);
  });
}

void Tool::output(std::string& path, const std::string& placeholder, const std::string& help,
                  Stream stream) {
  optional_output(path, "-o,--output", placeholder, help, stream);
  require("--output");
}

void Tool::optional_output(std::string& path, const std::string& names,
                           const std::string& placeholder, const std::string& help, Stream stream) {
  const std::string name = long_name(names);
  const std::string shown = stream == Stream::Yes ? help + "; - is standard output" : help;
  add_option(names, placeholder, "", shown,
             [&path](const std::string& word) { set_path(path, word); });
  m_parser->file_checks.emplace_back([this, &path, name, stream] {
    if (path == standard_output && stream == Stream::No)
      throw UsageError(name + ": cannot be standard output; for a file of this name write ./-");
    if (!path.empty())
      writes(name, path);
  });
  m_parser->app.footer("Outputs are written completely or not at all. If an output is a symbolic "
                       "link, the file it refers to is replaced.");
}

void Tool::optional_input(std::string& path, const std::string& names,
                          const std::string& placeholder, const std::string& help) {
  text(path, names, placeholder, help);
  m_parser->file_checks.emplace_back([this, &path, name = long_name(names)] { reads(name, path); });
}

void Tool::optional_inputs(std::vector<std::string>& paths, const std::string& names,
                           const std::string& placeholder, const std::string& help) {
  m_parser->app.add_option(names, paths, help)->type_name(placeholder)->expected(1, any_number);
  m_parser->file_checks.emplace_back([this, &paths, name = long_name(names)] {
    for (const std::string& path : paths)
      reads(name, path);
  });
}

void Tool::value(int& number, const std::string& names, const std::string& help, int low,
                 int high) {
  add_option(names, "INT", std::to_string(number), help, [&number, low, high](const auto& word) {
    number = static_cast<int>(parse_integer(word, low, high));
  });
}

void Tool::value(std::uint64_t& number, const std::string& names, const std::string& help) {
  add_option(names, "INT", std::to_string(number), help,
             [&number](const auto& word) { number = parse_unsigned(word); });
}

void Tool::value(double& number, const std::string& names, const std::string& help, double low,
                 double high) {
  add_option(names, "NUM", short_text(number), help,
             [&number, low, high](const auto& word) { number = parse_number(word, low, high); });
}

void Tool::value(float& number, const std::string& names, const std::string& help, double low,
                 double high) {
  add_option(names, "NUM", short_text(static_cast<double>(number)), help,
             [&number, low, high](const auto& word) {
               number = static_cast<float>(parse_number(word, low, high));
             });
}

void Tool::value(std::optional<int>& number, const std::string& names, const std::string& help,
                 int low, int high) {
  add_option(names, "INT", number ? std::to_string(*number) : "", help,
             [&number, low, high](const auto& word) {
               number = static_cast<int>(parse_integer(word, low, high));
             });
}

void Tool::value(std::optional<double>& number, const std::string& names, const std::string& help,
                 double low, double high) {
  add_option(names, "NUM", number ? short_text(*number) : "", help,
             [&number, low, high](const auto& word) { number = parse_number(word, low, high); });
}

void Tool::values(std::vector<double>& numbers, const std::string& names, const std::string& help,
                  std::size_t count, double low, double high) {
  add_option(names, joined(std::vector<std::string>(count, "NUM"), ","), list_text(numbers), help,
             [&numbers, count, low, high](const auto& word) {
               numbers = parse_numbers(word, count, low, high);
             });
}

void Tool::list(std::vector<int>& numbers, const std::string& names, const std::string& help,
                int low, int high) {
  add_list(names, "INT,...", list_text(numbers), help, [&numbers, low, high](const auto& words) {
    numbers.clear();
    for (const std::string& word : words)
      numbers.push_back(static_cast<int>(parse_integer(word, low, high)));
  });
}

void Tool::list(std::vector<double>& numbers, const std::string& names, const std::string& help,
                double low, double high) {
  add_list(names, "NUM,...", list_text(numbers), help, [&numbers, low, high](const auto& words) {
    numbers.clear();
    for (const std::string& word : words)
      numbers.push_back(parse_number(word, low, high));
  });
}

void Tool::text(std::string& text, const std::string& names, const std::string& placeholder,
                const std::string& help) {
  add_option(names, placeholder, text, help, [&text](const auto& word) { text = word; });
}

void Tool::texts(std::vector<std::string>& texts, const std::string& names,
                 const std::string& placeholder, const std::string& help) {
  m_parser->app.add_option(names, texts, help)->type_name(placeholder)->expected(1)->take_all();
}

void Tool::flag(bool& flag, const std::string& names, const std::string& help) {
  m_parser->app.add_flag(names, flag, help);
}

void Tool::require(const std::string& name) { m_parser->app.get_option(name)->required(); }

void Tool::offer_json() { flag(m_json, "--json", "Print results as one JSON object"); }

void Tool::alias(const std::string& old_name, const std::string& name) {
  m_parser->aliases[old_name] = name;
}

namespace {

/// Usage errors of an option name it.
template <class Function, class Argument>
void named(const std::string& names, const Function& setter, const Argument& argument) {
  try {
    setter(argument);
  } catch (const UsageError& error) {
    throw CLI::ValidationError(long_name(names), error.what());
  }
}

} // namespace

void Tool::add_option(const std::string& names, const std::string& placeholder,
                      const std::string& shown_default, const std::string& help,
                      const Setter& setter) {
  m_parser->app
      .add_option_function<std::string>(
          names, [setter, names](const std::string& word) { named(names, setter, word); },
          with_default(help, shown_default))
      ->type_name(placeholder);
}

void Tool::add_list(const std::string& names, const std::string& placeholder,
                    const std::string& shown_default, const std::string& help,
                    const ListSetter& setter) {
  const auto split_and_set = [setter, names](const std::vector<std::string>& texts) {
    std::vector<std::string> words;
    for (const std::string& text : texts)
      for (const std::string& word : split(text))
        words.push_back(word);
    named(names, setter, words);
  };
  m_parser->app
      .add_option_function<std::vector<std::string>>(names, split_and_set,
                                                     with_default(help, shown_default))
      ->type_name(placeholder)
      ->expected(1, any_number);
}

void Tool::add_choice(const std::string& names, const std::vector<std::string>& words,
                      const std::string& chosen, const std::string& help,
                      const std::function<void(std::size_t)>& setter) {
  const std::string list = joined(words, "|");
  add_option(names, list, chosen, help, [words, list, setter](const std::string& word) {
    setter(index_of(word, words, list));
  });
}

void Tool::add_choices(const std::string& names, const std::vector<std::string>& words,
                       const std::string& help,
                       const std::function<void(const std::vector<std::size_t>&)>& setter) {
  const std::string shown = "all, " + joined(words, ", ");
  add_list(names, "NAME,...|all", "", help,
           [words, shown, setter](const std::vector<std::string>& chosen) {
             std::vector<std::size_t> indices;
             for (const std::string& word : chosen)
               if (word == "all")
                 for (std::size_t i = 0; i < words.size(); ++i)
                   indices.push_back(i);
               else
                 indices.push_back(index_of(word, words, shown));
             setter(indices);
           });
}

bool Tool::given(const std::string& name) const { return m_parser->app.count(name) > 0; }

bool Tool::declares(const std::string& name) const {
  return m_parser->app.get_option_no_throw(name) != nullptr;
}

void Tool::reads(const std::string& role, const std::string& path) const {
  m_parser->files.add_input(role, path);
}

void Tool::writes(const std::string& role, const std::string& path) const {
  m_parser->files.add_output(role, path);
}

void Tool::check_files() const {
  for (const auto& check : m_parser->file_checks)
    check();
}

bool Tool::writes_standard_output() const { return m_parser->files.writes_standard_output(); }

/// Nothing if the command line is right, else the exit code.
std::optional<int> Tool::parse(int argc, const char* const* argv) {
  CLI::App& app = m_parser->app;
  try {
    app.parse(m_parser->arguments(argc, argv));
    return std::nullopt;
  } catch (const CLI::CallForHelp&) {
    return guarded([&] { return print(app.help()), exit_ok; });
  } catch (const CLI::CallForVersion&) {
    return guarded([&] { return print(version_line(m_name) + '\n'), exit_ok; });
  } catch (const CLI::ParseError& error) {
    return complain(exit_usage, std::string(error.what()) + " (see " + m_usage + " --help)");
  }
}

int run_program(int argc, const char* const* argv, const Command& program) {
  Tool tool(program.name, program.description);
  return program.run(tool, argc, argv);
}

int run_program(int argc, const char* const* argv, const std::string& name,
                const std::string& description, const std::vector<Command>& subcommands) {
  std::vector<std::string> names;
  std::string help = "Subcommand; `" + name + " COMMAND --help` lists its options.";
  for (const Command& subcommand : subcommands) {
    if (argc > 1 && argv[1] == subcommand.name) {
      Tool tool(name + " " + subcommand.name, subcommand.description);
      return subcommand.run(tool, argc - 1, argv + 1);
    }
    names.push_back(subcommand.name);
    help.append(" ").append(subcommand.name).append(": ").append(subcommand.description);
  }
  Tool tool(name, description);
  std::string unknown;
  tool.input(unknown, "COMMAND", help);
  return tool.run(argc, argv, [&]() -> int {
    throw UsageError("'" + unknown + "' is none of " + joined(names, "|"));
  });
}

} // namespace haarlight::tool
