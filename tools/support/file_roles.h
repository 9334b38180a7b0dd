#pragma once
// Which files a run reads and writes: no output may be another file of the same run.

#include <map>
#include <string>

namespace haarlight::tool {

class FileRoles {
public:
  /// Files are the same whatever their spelling: by links, hard or symbolic, as well. An output
  /// that does not exist yet is known by its folder and name.
  /// @param role for messages, as in "--png"
  /// @throws UsageError if the file is an output already, Error(Output) for a loop of links
  void add_output(const std::string& role, const std::string& path);
  /// Inputs may be named twice, but for standard input, "-", which is read once.
  /// @throws UsageError if the file is an output, or standard input a second time
  void add_input(const std::string& role, const std::string& path);

  /// One of the outputs is "-".
  bool writes_standard_output() const { return m_standard_output; }

private:
  struct Role {
    std::string name;
    bool output;
  };
  void add(const std::string& identity, const std::string& path, const Role& role);

  std::map<std::string, Role> m_roles; ///< by identity
  std::string m_standard_input;        ///< role of the input that is "-"
  bool m_standard_output = false;
};

} // namespace haarlight::tool
