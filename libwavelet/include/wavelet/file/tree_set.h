#pragma once
// .haar files: sets of trees in one file, specified in FORMAT.md. The mapped form is used in place;
// the packed form is for transport: several times smaller, and unpacked to the mapped form byte for
// byte.

#include <wavelet/file/input_file.h>
#include <wavelet/file/output_file.h>
#include <wavelet/tree/map_set.h>
#include <wavelet/tree/tree.h>

#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace haarlight::wavelet {

class SetLayout;

/// When the trees of a file are checked. Header, index and text are checked at opening either way,
/// and no tree is ever handed out unchecked.
enum class Check {
  Everything, ///< all trees at opening, from several threads
  WhenUsed    ///< a tree is read and checked when it is first asked for
};

/// A .haar file in its mapped form. Trees are used in place in a private copy of the file, so
/// that later changes to the file have no effect.
class TreeSet {
public:
  /// Reads the file and checks it: checksum and structure of a tree in one go.
  /// @throws Error(Input) naming the first broken rule of FORMAT.md and its byte offset; for a
  ///         packed file, the command that unpacks it
  explicit TreeSet(const std::string& path, Check check = Check::Everything);
  explicit TreeSet(InputFile file, Check check = Check::Everything);

  const std::string& path() const { return m_file.path(); }
  std::uint64_t file_bytes() const { return m_file.size(); }
  std::span<const std::byte> bytes() const { return m_file.bytes(); }
  const SetInfo& info() const { return m_info; }
  int levels() const { return m_levels; }
  int channels() const { return m_channels; }
  CoefficientType coefficients() const { return m_type; }

  /// The stored tree of a column and a row; valid while this set lives. Safe from several threads.
  /// @param column 0 ≤ column < info().columns
  /// @param row    0 ≤ row < info().rows
  /// @throws Error(Input) with Check::WhenUsed, if the tree breaks a rule
  const TreeView& tree(int column, int row) const {
    const std::size_t i = place(column, row);
    if (!m_checked[i].set.load(std::memory_order_acquire))
      check_tree(i);
    return m_trees[i];
  }

  /// Nodes of a tree at a level, 0 ≤ level < levels(). @throws as tree()
  std::uint32_t level_nodes(int column, int row, int level) const;

  /// Bytes a tree takes in the file.
  std::uint64_t tree_bytes(int column, int row) const;

private:
  /// An atomic that a vector can hold.
  struct Flag {
    std::atomic<bool> set = false;
  };

  std::size_t place(int column, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(m_info.columns) +
           static_cast<std::size_t>(column);
  }
  std::uint64_t bytes_of(const TreeView& view) const;
  void check_tree(std::size_t i) const;

  InputFile m_file;
  SetInfo m_info;
  int m_levels = 0;
  int m_channels = 3;
  CoefficientType m_type = CoefficientType::Half;
  std::vector<TreeView> m_trees;
  std::vector<std::uint64_t> m_checksums;
  mutable std::vector<Flag> m_checked;
  /// A tree is read and checked by one thread, which holds one of these.
  std::unique_ptr<std::array<std::mutex, 64>> m_mutexes =
      std::make_unique<std::array<std::mutex, 64>>();
};

/// True if the first bytes are those of a .haar file of either form, which may be damaged all the
/// same.
bool begins_as_tree_set(const InputFile& file);

/// Takes the trees of a set one after the other, column fastest, then finish().
class TreeSink {
public:
  virtual ~TreeSink() = default;
  /// @throws Error(Output)
  virtual void add(Tree tree) = 0;
  /// All trees must have been added. @throws Error(Output)
  virtual void finish() = 0;
};

/// Writes a set in its mapped form. Memory: the index.
class TreeSetWriter : public TreeSink {
public:
  /// @param levels   log2 of info.size
  /// @param channels 3 or 1
  TreeSetWriter(OutputFile& file, const SetInfo& info, int channels, CoefficientType type);
  ~TreeSetWriter() override;

  void add(Tree tree) override;
  void finish() override;

  /// After finish(): the header as written.
  std::span<const std::byte> header() const;

private:
  OutputFile& m_file;
  std::unique_ptr<SetLayout> m_layout;
};

enum class FileForm { Mapped, Packed };

/// The form of a .haar file, detected from its first bytes; empty if it is not a .haar file.
/// @throws Error(Input) if it cannot be read
std::optional<FileForm> file_form(const InputFile& file);
std::optional<FileForm> file_form(const std::string& path);

/// Writes a set in its packed form, some blocks of trees at a time and from several threads. The
/// bytes depend on the trees, the SetInfo and the version of libzstd alone. Memory: the index and
/// some blocks of at most 4 MiB of trees, or of one tree.
class PackedSetWriter : public TreeSink {
public:
  /// @param channels 3 or 1
  PackedSetWriter(OutputFile& file, const SetInfo& info, int channels, CoefficientType type);
  ~PackedSetWriter() override;

  void add(Tree tree) override;
  void finish() override;

  /// After finish(): the header that the mapped form begins with.
  std::span<const std::byte> mapped_header() const;

private:
  void close_block();
  void flush();

  OutputFile& m_file;
  std::unique_ptr<SetLayout> m_layout;
  std::uint64_t m_pending_bytes = 0;
  std::vector<Tree> m_pending;
  std::vector<std::vector<Tree>> m_blocks;
  std::uint32_t m_block_count = 0;
  std::uint64_t m_empty_nodes = 0;
  std::vector<std::byte> m_text_frame;
};

/// Packs a mapped file. The caller commits `file`.
/// @throws Error(Input) if the mapped file breaks a rule, or is laid out as no writer of version 1
///         does (its text section, for example, names something twice)
void pack(const std::string& mapped_path, OutputFile& file, const Progress& progress = {});

/// Unpacks a packed file; every rule of FORMAT.md is checked on the way. The caller commits `file`.
/// @throws Error(Input) naming the first broken rule and its byte offset in the packed file
void unpack(const std::string& packed_path, OutputFile& file, const Progress& progress = {});

/// Opens either form. A packed file is unpacked into memory.
/// @throws as unpack() and TreeSet(), and Error(Input) if that takes more than available_memory()
TreeSet open_tree_set(InputFile file, Check check = Check::Everything);
TreeSet open_tree_set(const std::string& path, Check check = Check::Everything);

} // namespace haarlight::wavelet
