#pragma once
// The frame of every command-line program: options, --help, --version, -q, -v, --threads, --json,
// exit codes and the one line on stderr. Usage:
//
//   tool::Tool app("brdf2maps", "Resamples a measured BRDF into a set of maps.");
//   app.input(in, "IN.binary", "MERL file");
//   app.output(out, "OUT.exr", "map set to write");
//   app.value(size, "--size", "pixels along a map's side", 1, 4096);
//   return app.run(argc, argv, [&] { …; return tool::exit_ok; });
//
// An option's value at declaration is its default, shown by --help. Help texts name the unit.

#include <support/file_roles.h>
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
inline constexpr int exit_no = 1;       ///< a comparison or validation says no
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
  /// @param name of the program, and behind a blank that of its command if it has several
  Tool(const std::string& name, const std::string& description);
  ~Tool();
  Tool(const Tool&) = delete;
  Tool& operator=(const Tool&) = delete;

  // Files that are declared here are checked before the body is called: an output that is also an
  // input or another output is a usage error. Options with other texts that name files add theirs
  // by reads() and writes().

  /// A required positional argument: a path, "-" for standard input.
  void input(std::string& path, const std::string& placeholder, const std::string& help);
  /// One or more positional paths.
  void inputs(std::vector<std::string>& paths, const std::string& placeholder,
              const std::string& help);
  /// The required option -o, --output. With Stream::Yes "-" is standard output; results then go to
  /// stderr.
  void output(std::string& path, const std::string& placeholder, const std::string& help,
              Stream stream = Stream::Yes);
  /// The same by an option that may be left out; the path is then empty.
  void optional_output(std::string& path, const std::string& names, const std::string& placeholder,
                       const std::string& help, Stream stream = Stream::Yes);
  /// A further path that is read, if it is given.
  void optional_input(std::string& path, const std::string& names, const std::string& placeholder,
                      const std::string& help);
  /// One or more such paths, any number of times.
  void optional_inputs(std::vector<std::string>& paths, const std::string& names,
                       const std::string& placeholder, const std::string& help);

  /// `names` is as in "-s,--size". Numbers outside [low, high], and anything that is no number, are
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
  /// Any text; `placeholder` is what --help shows for it.
  void text(std::string& text, const std::string& names, const std::string& placeholder,
            const std::string& help);
  /// Any text, given any number of times.
  void texts(std::vector<std::string>& texts, const std::string& names,
             const std::string& placeholder, const std::string& help);
  /// The same, with one or more texts each time.
  void text_list(std::vector<std::string>& texts, const std::string& names,
                 const std::string& placeholder, const std::string& help);
  void flag(bool& flag, const std::string& names, const std::string& help);

  /// One of a few names, each standing for a value.
  template <class E>
  void choice(E& value, const std::string& names,
              const std::vector<std::pair<std::string, E>>& choices, const std::string& help) {
    std::vector<std::string> words;
    std::string chosen;
    for (const auto& [word, meaning] : choices) {
      words.push_back(word);
      if (meaning == value)
        chosen = word;
    }
    add_choice(names, words, chosen, help,
               [&value, choices](std::size_t index) { value = choices[index].second; });
  }
  /// The option must be given.
  void require(const std::string& name);
  /// Adds --json: results as one JSON object instead of aligned text.
  void offer_json();

  /// Parses the command line and calls `body`, which returns an exit code. Errors it throws become
  /// exit codes and one line on stderr. Call once.
  int run(int argc, const char* const* argv, const std::function<int()>& body);

  /// Files that the body learns of, for example from a scene: before they are opened.
  /// @param role for messages, as in "the scene's probe". @throws UsageError if one is an output,
  /// or
  ///             for writes() any file of this run
  void reads(const std::string& role, const std::string& path) const;
  void writes(const std::string& role, const std::string& path) const;

  // What a body may ask and say.
  bool
  given(const std::string& name) const; ///< the option, as in "--size", was on the command line
  bool knows(const std::string& name) const; ///< there is such an option
  bool quiet() const { return m_quiet; }
  bool verbose() const { return m_verbose; }
  bool json() const { return m_json; }
  const std::string& name() const { return m_name; }

  /// A diagnostic line on stderr, unless --quiet: at once with --verbose, else when the body is
  /// done, and not at all if it fails, so that the error stands alone. Not safe from several
  /// threads.
  void note(const std::string& line) const;
  /// A diagnostic line on stderr with --verbose only.
  void detail(const std::string& line) const;
  /// A result on stdout, as text or with --json as an object; on stderr, and not at all with
  /// --quiet, if stdout takes an output. @throws Error(Output)
  void print(const Report& report) const;
  /// Raw text likewise. @throws Error(Output), for example for a closed pipe
  void print(const std::string& text) const;

private:
  struct Parser;
  using Setter = std::function<void(const std::string& word)>;

  void add_option(const std::string& names, const std::string& placeholder,
                  const std::string& shown_default, const std::string& help, Setter setter);
  void add_choice(const std::string& names, const std::vector<std::string>& words,
                  const std::string& chosen, const std::string& help,
                  const std::function<void(std::size_t)>& setter);
  void check_files() const;
  std::optional<int> parse(int argc, const char* const* argv);
  int guarded(const std::function<int()>& body) const;
  int complain(int code, const std::string& message) const;

  std::string m_name;
  std::string m_usage; ///< what --help is asked of: the name, with the command
  std::unique_ptr<Parser> m_parser;
  mutable std::vector<std::string> m_notes;
  std::vector<std::function<void()>> m_file_checks; ///< of what was declared
  mutable FileRoles m_files;
  bool m_quiet = false;
  bool m_verbose = false;
  bool m_json = false;
  int m_threads = 0;
};

} // namespace haarlight::tool
