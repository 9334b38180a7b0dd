#include "file/set_layout.h"

#include <wavelet/file/tree_set.h>

namespace haarlight::wavelet {

TreeSetWriter::TreeSetWriter(OutputFile& file, const SetInfo& info, int channels,
                             CoefficientType type)
    : m_file(file), m_layout(std::make_unique<SetLayout>(info, channels, type)) {
  m_file.seek(align_up(sizeof(FileHeader)));
}

TreeSetWriter::~TreeSetWriter() = default;

void TreeSetWriter::add(Tree tree) {
  const std::vector<std::byte> bytes = m_layout->add(tree);
  m_file.write(bytes.data(), bytes.size());
}

void TreeSetWriter::finish() {
  m_layout->finish();
  const auto index = std::as_bytes(std::span(m_layout->index()));
  m_file.write(index.data(), index.size());
  m_file.write(m_layout->text().data(), m_layout->text().size());
  const std::uint64_t end = m_file.position();
  unsigned char padded[128] = {};
  static_assert(sizeof padded == (sizeof(FileHeader) + 15) / 16 * 16);
  std::memcpy(padded, &m_layout->header(), sizeof(FileHeader));
  m_file.seek(0);
  m_file.write(padded, sizeof padded);
  m_file.seek(end);
}

std::span<const std::byte> TreeSetWriter::header() const {
  return std::as_bytes(std::span(&m_layout->header(), 1));
}

} // namespace haarlight::wavelet
