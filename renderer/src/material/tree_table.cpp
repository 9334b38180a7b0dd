#include <renderer/material/tree_table.h>

#include <wavelet/base/error.h>
#include <wavelet/base/parallel.h>

namespace haarlight::renderer {

using wavelet::SetKind;

TreeTable::TreeTable(const std::string& path, SetKind kind, wavelet::Check check)
    : m_file(std::make_unique<wavelet::TreeSet>(path, check)), m_info(m_file->info()) {
  if (m_info.kind != kind)
    throw_input_error(path, kind == SetKind::Brdf
                                ? "holds no BRDF set; one made by brdf2maps is needed"
                                : "holds no light set; one made by probe2maps is needed");
}

TreeTable::TreeTable(const wavelet::MapSource& source) : m_info(source.info()) {
  m_owned.resize(static_cast<std::size_t>(m_info.map_count()));
  wavelet::CompressOptions options;
  options.threshold.tolerance = default_tolerance(m_info, options.threshold.criterion);
  parallel_for(m_owned.size(), [&](std::size_t i) {
    const int index = static_cast<int>(i);
    wavelet::CompressReport report;
    m_owned[i] =
        compress_map(source.make(index % m_info.columns, index / m_info.columns), options, report);
  });
  for (const wavelet::Tree& tree : m_owned)
    m_views.push_back(tree.view());
}

std::vector<wavelet::TreeView> TreeTable::trees() const {
  std::vector<wavelet::TreeView> all;
  all.reserve(static_cast<std::size_t>(m_info.map_count()));
  for (int row = 0; row < m_info.rows; ++row)
    for (int column = 0; column < m_info.columns; ++column)
      all.push_back(tree(column, row));
  return all;
}

} // namespace haarlight::renderer
