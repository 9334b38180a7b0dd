#pragma once
// The frame of every command-line program: options, subcommands, --help, --version, -q, -v,
// --threads, --json, exit codes and the one line on stderr. Usage:
//
//   struct Options { std::string input, output; int size = 512; };
//   void declare(tool::Tool& app, Options& o) {
//     app.input(o.input, "IN.binary", "MERL file");
//     app.output(o.output, "OUT.exr", "Map set to write");
//     app.value(o.size, "--size", "Pixels along a map's side", 1, 4096);
//   }
//   int make_maps(const tool::Tool& app, const Options& o) { …; return tool::exit_ok; }
//   int main(int argc, char** argv) {
//     return tool::run_program(
//         argc, argv, tool::command("brdf2maps", "Resamples a BRDF.", declare, make_maps));
//   }
//
// An option's value at declaration is its default, which --help shows. Help texts name the unit.

#include <support/report.h>

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace haarlight::tool {

inline constexpr int exit_ok = 0;
inline constexpr int exit_no = 1;       ///< a comparison or validation failed
inline constexpr int exit_usage = 2;    ///< the command line is wrong
inline constexpr int exit_input = 3;    ///< input unreadable or malformed
inline constexpr int exit_output = 4;   ///< output could not be written
inline constexpr int exit_internal = 5; ///< a fault of the program, or memory ran out

/// Thrown by a body when options contradict each other; exit code 2.
class UsageError : public std::runtime_error {
public:
  using std::runtime_error::runtime_error;
};

/// Whether an output may be standard output.
enum class Stream { No, Yes };

class Tool {
public:
  /// @param name of the program, followed by that of the subcommand if there is one
  Tool(const std::string& name, const std::string& description);
  ~Tool();
  Tool(const Tool&) = delete;
  Tool& operator=(const Tool&) = delete;

  // Files declared here are checked before the body is called: an output that is also an input or
  // another output is a usage error. The body registers files it finds in its inputs by reads()
  // and writes().

  /// A required positional argument: a path, "-" for standard input.
  void input(std::string& path, const std::string& placeholder, const std::string& help);
  /// One or more positional paths.
  void inputs(std::vector<std::string>& paths, const std::string& placeholder,
              const std::string& help);
  /// The required option -o, --output. With Stream::Yes "-" is standard output; results then go to
  /// stderr.
  void output(std::string& path, const std::string& placeholder, const std::string& help,
              Stream stream = Stream::Yes);
  /// The same for an option that may be omitted; the path is then empty.
  void optional_output(std::string& path, const std::string& names, const std::string& placeholder,
                       const std::string& help, Stream stream = Stream::Yes);
  /// An optional path that is read.
  void optional_input(std::string& path, const std::string& names, const std::string& placeholder,
                      const std::string& help);
  /// One or more such paths; the option may be repeated.
  void optional_inputs(std::vector<std::string>& paths, const std::string& names,
                       const std::string& placeholder, const std::string& help);

  /// `names` is as in "-s,--size". Numbers outside [low, high], and text that is no number, are
  /// usage errors.
  void value(int& number, const std::string& names, const std::string& help, int low, int high);
  void value(std::uint64_t& number, const std::string& names, const std::string& help);
  void value(double& number, const std::string& names, const std::string& help, double low,
             double high);
  void value(float& number, const std::string& names, const std::string& help, double low,
             double high);
  /// The same without a default.
  void value(std::optional<int>& number, const std::string& names, const std::string& help, int low,
             int high);
  void value(std::optional<double>& number, const std::string& names, const std::string& help,
             double low, double high);
  /// `count` numbers separated by commas, as in 0.9,0.6,0.2; `numbers` holds the default, or
  /// nothing.
  void values(std::vector<double>& numbers, const std::string& names, const std::string& help,
              std::size_t count, double low, double high);
  /// One or more numbers, separated by commas or blanks; they replace the default.
  void list(std::vector<int>& numbers, const std::string& names, const std::string& help, int low,
            int high);
  void list(std::vector<double>& numbers, const std::string& names, const std::string& help,
            double low, double high);
  /// Any text; --help shows `placeholder`.
  void text(std::string& text, const std::string& names, const std::string& placeholder,
            const std::string& help);
  /// Any text; the option may be repeated.
  void texts(std::vector<std::string>& texts, const std::string& names,
             const std::string& placeholder, const std::string& help);
  void flag(bool& flag, const std::string& names, const std::string& help);

  /// A name from a list, each name with a value.
  template <class E>
  void choice(E& value, const std::string& names,
              const std::vector<std::pair<std::string, E>>& choices, const std::string& help) {
    std::string chosen;
    for (const auto& [word, meaning] : choices)
      if (meaning == value)
        chosen = word;
    add_choice(names, words_of(choices), chosen, help,
               [&value, choices](std::size_t index) { value = choices[index].second; });
  }
  /// One or more of these names, separated by commas or blanks; "all" stands for all of them.
  template <class E>
  void choices(std::vector<E>& values, const std::string& names,
               const std::vector<std::pair<std::string, E>>& choices, const std::string& help) {
    add_choices(names, words_of(choices), help,
                [&values, choices](const std::vector<std::size_t>& indices) {
                  values.clear();
                  for (const std::size_t index : indices)
                    values.push_back(choices[index].second);
                });
  }
  /// Makes a declared option required.
  void require(const std::string& name);
  /// Adds --json: results as one JSON object instead of aligned text.
  void offer_json();
  /// Accepts an old spelling of an option, as in alias("--against", "--reference"); --help does not
  /// show it.
  void alias(const std::string& old_name, const std::string& name);

  /// Parses the command line and calls `body`, which returns an exit code. Errors it throws become
  /// exit codes and one line on stderr. Call once.
  int run(int argc, const char* const* argv, const std::function<int()>& body);

  /// Registers a file that the body found, for example in a scene; call before opening it.
  /// @param role for messages, as in "the scene's probe"
  /// @throws UsageError if one is an output, or for writes() any file of this run
  void reads(const std::string& role, const std::string& path) const;
  void writes(const std::string& role, const std::string& path) const;

  /// Whether an option, as in "--size", was on the command line.
  bool given(const std::string& name) const;
  /// Whether such an option is declared.
  bool declares(const std::string& name) const;
  bool quiet() const { return m_quiet; }
  bool verbose() const { return m_verbose; }
  bool json() const { return m_json; }
  const std::string& name() const { return m_name; }

  /// A diagnostic line on stderr, unless --quiet: at once with --verbose, else after the body, and
  /// not at all if the body fails, so that the error stands alone. Not thread-safe.
  void note(const std::string& line) const;
  /// A diagnostic line on stderr with --verbose only.
  void detail(const std::string& line) const;
  /// A result on stdout, as text or with --json as an object. If stdout takes an output: on
  /// stderr, or with --quiet nowhere. @throws Error(Output)
  void print(const Report& report) const;
  /// The same for raw text. @throws Error(Output), for example for a closed pipe
  void print(const std::string& text) const;

private:
  struct Parser;
  using Setter = std::function<void(const std::string& word)>;
  using ListSetter = std::function<void(const std::vector<std::string>& words)>;

  template <class E>
  static std::vector<std::string> words_of(const std::vector<std::pair<std::string, E>>& choices) {
    std::vector<std::string> words;
    words.reserve(choices.size());
    for (const auto& choice : choices)
      words.push_back(choice.first);
    return words;
  }

  void add_option(const std::string& names, const std::string& placeholder,
                  const std::string& shown_default, const std::string& help, const Setter& setter);
  void add_list(const std::string& names, const std::string& placeholder,
                const std::string& shown_default, const std::string& help,
                const ListSetter& setter);
  void add_choice(const std::string& names, const std::vector<std::string>& words,
                  const std::string& chosen, const std::string& help,
                  const std::function<void(std::size_t)>& setter);
  void add_choices(const std::string& names, const std::vector<std::string>& words,
                   const std::string& help,
                   const std::function<void(const std::vector<std::size_t>&)>& setter);
  std::optional<int> parse(int argc, const char* const* argv);
  void check_files() const;
  bool writes_standard_output() const;
  int guarded(const std::function<int()>& body) const;
  int complain(int code, const std::string& message) const;

  std::string m_name;
  std::string m_usage; ///< name with subcommand, whose --help usage errors refer to
  std::unique_ptr<Parser> m_parser;
  mutable std::vector<std::string> m_notes;
  bool m_quiet = false;
  bool m_verbose = false;
  bool m_json = false;
  int m_threads = 0;
};

/// A program, or one subcommand of it.
struct Command {
  std::string name;
  std::string description;
  /// Declares the options, parses the command line and calls the body.
  std::function<int(Tool& tool, int argc, const char* const* argv)> run;
};

/// A command whose options are one struct.
/// @param declare adds the options; their values before parsing are the defaults
/// @param body    called as body(tool, options), returns an exit code
template <class Options, class Body>
Command command(const std::string& name, const std::string& description,
                void (*declare)(Tool&, Options&), Body body) {
  return {name, description, [declare, body](Tool& tool, int argc, const char* const* argv) {
            Options options;
            declare(tool, options);
            return tool.run(argc, argv, [&] { return body(tool, options); });
          }};
}

/// The main() of a program with one command. @return the exit code
int run_program(int argc, const char* const* argv, const Command& program);

/// The main() of a program `name SUBCOMMAND …`. Without a subcommand: --help lists them, --version,
/// or exit code 2.
int run_program(int argc, const char* const* argv, const std::string& name,
                const std::string& description, const std::vector<Command>& subcommands);

} // namespace haarlight::tool
