#pragma once
// Packed .haar files: the transport form of a set of trees, several times smaller than the mapped
// one and not usable where it lies. FORMAT.md specifies both. Unpacking gives the mapped file back
// byte for byte.

#include <wavelet/file/input_file.h>
#include <wavelet/file/output_file.h>
#include <wavelet/file/tree_set.h>
#include <wavelet/tree/map_set.h>

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace haarlight::wavelet {

enum class FileForm { Mapped, Packed };

/// Which form of a .haar file this is by its first bytes; nothing if it is no .haar file.
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
