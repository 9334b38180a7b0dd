#include <support/tool.h>

#include <wavelet/file/output_file.h>
#include <wavelet/file/provenance.h>

#include <CLI/CLI.hpp>

#include <algorithm>

namespace haarlight::tool {

struct Tool::Parser {
  CLI::App app;
};

namespace {

std::string version_line(const std::string& name) {
  std::string version = version_text(); // "haarlight 0.1.0"
  return name + " (" + version.insert(version.find(' '), ")");
}

/// Of names as in "-o,--output".
std::string long_name(const std::string& names) { return names.substr(names.find("--")); }

/// A path that is needed: CLI11 itself would let an empty one pass.
void set_path(std::string& path, const std::string& word) {
  if (word.empty())
    throw CLI::ValidationError("a path is empty");
  path = word;
}

} // namespace

Tool::Tool(const std::string& name, const std::string& description)
    : m_name(name.substr(0, name.find(' '))), m_usage(name), m_parser(std::make_unique<Parser>()) {
  m_parser->app.name(m_usage);
  m_parser->app.description(m_usage + ": " + description);
  m_parser->app.set_help_flag("-h,--help", "Print this help and exit");
  m_parser->app.set_version_flag("--version", version_line(m_name), "Print the version and exit");
  flag(m_quiet, "-q,--quiet", "No notes and no progress on stderr");
  flag(m_verbose, "-v,--verbose", "More notes on stderr");
  value(m_threads, "--threads", "Threads to use; 0 = as many as the machine offers", 0, 4096);
}

Tool::~Tool() = default;

void Tool::input(std::string& path, const std::string& placeholder, const std::string& help) {
  m_parser->app
      .add_option_function<std::string>(
          placeholder, [&path](const std::string& word) { set_path(path, word); }, help)
      ->type_name("")
      ->required();
  m_file_checks.emplace_back([this, &path, placeholder] { reads(placeholder, path); });
}

void Tool::inputs(std::vector<std::string>& paths, const std::string& placeholder,
                  const std::string& help) {
  m_parser->app.add_option(placeholder, paths, help)->type_name("")->required();
  m_file_checks.emplace_back([this, &paths, placeholder] {
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
  m_file_checks.emplace_back([this, &path, name, stream] {
    if (path == standard_output && stream == Stream::No)
      throw UsageError(name + ": cannot be standard output; for a file of this name write ./-");
    if (!path.empty())
      writes(name, path);
  });
  m_parser->app.footer(
      "Outputs appear whole or not at all. A symbolic link is written through: the "
      "file that it leads to is replaced.");
}

void Tool::optional_input(std::string& path, const std::string& names,
                          const std::string& placeholder, const std::string& help) {
  text(path, names, placeholder, help);
  m_file_checks.emplace_back([this, &path, name = long_name(names)] { reads(name, path); });
}

void Tool::optional_inputs(std::vector<std::string>& paths, const std::string& names,
                           const std::string& placeholder, const std::string& help) {
  text_list(paths, names, placeholder, help);
  m_file_checks.emplace_back([this, &paths, name = long_name(names)] {
    for (const std::string& path : paths)
      reads(name, path);
  });
}

void Tool::reads(const std::string& role, const std::string& path) const {
  m_files.add_input(role, path);
}

void Tool::writes(const std::string& role, const std::string& path) const {
  m_files.add_output(role, path);
}

void Tool::check_files() const {
  for (const auto& check : m_file_checks)
    check();
}

void Tool::texts(std::vector<std::string>& texts, const std::string& names,
                 const std::string& placeholder, const std::string& help) {
  m_parser->app.add_option(names, texts, help)->type_name(placeholder)->expected(1)->take_all();
}

void Tool::text_list(std::vector<std::string>& texts, const std::string& names,
                     const std::string& placeholder, const std::string& help) {
  m_parser->app.add_option(names, texts, help)->type_name(placeholder)->expected(1, 1 << 20);
}

void Tool::flag(bool& flag, const std::string& names, const std::string& help) {
  m_parser->app.add_flag(names, flag, help);
}

void Tool::add_option(const std::string& names, const std::string& placeholder,
                      const std::string& shown_default, const std::string& help, Setter setter) {
  const auto checked = [setter = std::move(setter), names](const std::string& word) {
    try {
      setter(word);
    } catch (const UsageError& error) {
      throw CLI::ValidationError(long_name(names), error.what());
    }
  };
  const std::string shown = shown_default.empty() ? help : help + " [" + shown_default + "]";
  m_parser->app.add_option_function<std::string>(names, checked, shown)->type_name(placeholder);
}

void Tool::add_choice(const std::string& names, const std::vector<std::string>& words,
                      const std::string& chosen, const std::string& help,
                      const std::function<void(std::size_t)>& setter) {
  std::string list;
  for (const std::string& word : words)
    list.append(list.empty() ? "" : "|").append(word);
  add_option(names, list, chosen, help, [words, list, setter](const std::string& word) {
    const auto place = std::find(words.begin(), words.end(), word);
    if (place == words.end())
      throw UsageError("'" + word + "' is none of " + list);
    setter(static_cast<std::size_t>(place - words.begin()));
  });
}

void Tool::require(const std::string& name) { m_parser->app.get_option(name)->required(); }

void Tool::offer_json() { flag(m_json, "--json", "Print results as one JSON object"); }

bool Tool::given(const std::string& name) const { return m_parser->app.count(name) > 0; }

bool Tool::knows(const std::string& name) const {
  return m_parser->app.get_option_no_throw(name) != nullptr;
}

/// Nothing if the command line is right, else the exit code.
std::optional<int> Tool::parse(int argc, const char* const* argv) {
  CLI::App& app = m_parser->app;
  try {
    app.parse(argc, argv);
    return std::nullopt;
  } catch (const CLI::CallForHelp&) {
    return guarded([&] { return print(app.help()), exit_ok; });
  } catch (const CLI::CallForVersion&) {
    return guarded([&] { return print(version_line(m_name) + '\n'), exit_ok; });
  } catch (const CLI::ParseError& error) {
    return complain(exit_usage, std::string(error.what()) + " (see " + m_usage + " --help)");
  }
}

} // namespace haarlight::tool
