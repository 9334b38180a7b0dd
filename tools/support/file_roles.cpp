#include <support/file_roles.h>

#include <support/tool.h>

#include <wavelet/file/output_file.h>

#include <sys/stat.h>
#include <unistd.h>

namespace haarlight::tool {
namespace {

constexpr const char* standard_input = "-";

std::string inode_text(const struct stat& status) {
  return std::to_string(status.st_dev) + ":" + std::to_string(status.st_ino);
}

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

void FileRoles::add_output(const std::string& role, const std::string& path) {
  m_standard_output = m_standard_output || path == standard_output;
  add(output_identity(path), path, {role, true});
}

void FileRoles::add_input(const std::string& role, const std::string& path) {
  if (path == standard_input || path == "/dev/stdin") {
    if (!m_standard_input.empty())
      throw UsageError(role + ": '" + path +
                       "' is standard input, which is read once, already as " + m_standard_input);
    m_standard_input = role;
    return;
  }
  struct stat status = {};
  if (::stat(path.c_str(), &status) == 0) // a missing input is an error of its reader
    add(inode_text(status), path, {role, false});
}

void FileRoles::add(const std::string& identity, const std::string& path, const Role& role) {
  const auto [place, is_new] = m_roles.emplace(identity, role);
  if (is_new || (!role.output && !place->second.output))
    return;
  const bool two_outputs = role.output && place->second.output;
  const std::string& output = role.output ? role.name : place->second.name;
  const std::string& other = role.output ? place->second.name : role.name;
  throw UsageError(output + ": '" + path + "' is the same file as " +
                   (two_outputs ? "the output " : "the input ") + other);
}

} // namespace haarlight::tool
