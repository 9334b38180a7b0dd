// What a program does once its command line is read: the body, its errors and its output.
#include <support/process.h>
#include <support/tool.h>

#include <wavelet/base/error.h>
#include <wavelet/base/memory.h>
#include <wavelet/base/parallel.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>

namespace haarlight::tool {
namespace {

/// Diagnostics are one line, whatever characters a file name has.
std::string one_line(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](char c) { return static_cast<unsigned char>(c) < ' '; }, ' ');
  return text;
}

void say(const std::string& line) {
  const std::string text = line + '\n';
  std::fwrite(text.data(), 1, text.size(), stderr);
}

} // namespace

int Tool::run(int argc, const char* const* argv, const std::function<int()>& body) {
  prepare_process(m_name);
  if (const auto code = parse(argc, argv))
    return *code;
  const ThreadLimit limit(m_threads);
  const int code = guarded([&] {
    check_files();
    return body();
  });
  if (code < exit_usage && !m_quiet)
    std::for_each(m_notes.begin(), m_notes.end(), say);
  return code;
}

int Tool::guarded(const std::function<int()>& body) const {
  try {
    return body();
  } catch (const UsageError& error) {
    return complain(exit_usage, std::string(error.what()) + " (see " + m_usage + " --help)");
  } catch (const Error& error) {
    return complain(error.kind() == ErrorKind::Input ? exit_input : exit_output, error.what());
  } catch (const OutOfMemory& error) {
    return complain(exit_internal, error.what());
  } catch (const std::bad_alloc&) {
    return complain(exit_internal, "out of memory");
  } catch (const std::exception& error) {
    return complain(exit_internal, error.what());
  }
}

int Tool::complain(int code, const std::string& message) const {
  say(m_name + ": " + one_line(message));
  return code;
}

void Tool::note(const std::string& line) const {
  const std::string text = m_name + ": " + one_line(line);
  if (m_verbose && !m_quiet)
    say(text);
  else
    m_notes.push_back(text);
}

void Tool::detail(const std::string& line) const {
  if (m_verbose)
    note(line);
}

void Tool::print(const Report& report) const { print(m_json ? report.json() : report.text()); }

void Tool::print(const std::string& text) const {
  const bool aside = m_files.writes_standard_output();
  if (aside && m_quiet)
    return;
  std::FILE* const stream = aside ? stderr : stdout;
  const bool written = std::fwrite(text.data(), 1, text.size(), stream) == text.size();
  if (!written || std::fflush(stream) != 0)
    throw_output_error(aside ? "standard error" : "standard output",
                       std::string("cannot be written: ") + std::strerror(errno));
}

} // namespace haarlight::tool
