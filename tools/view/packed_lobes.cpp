#include <view/packed_lobes.h>

#include <wavelet/base/half.h>
#include <wavelet/tree/pyramid.h>

#include <algorithm>

namespace haarlight::view {

using wavelet::Pyramid;

namespace {

/// The square at (x, y) of a level, or one step outside: across an edge lies the same edge,
/// mirrored. Squares as fine as the finest count as varying within as their surroundings do, since
/// one that is seen turned lies across several.
Float4 square_of(const Pyramid& pyramid, int entry, int level, int x, int y) {
  const int last = (1 << level) - 1;
  if (x < 0 || x > last) {
    x = std::clamp(x, 0, last);
    y = last - y;
  }
  if (y < 0 || y > last) {
    y = std::clamp(y, 0, last);
    x = std::clamp(last - x, 0, last);
  }
  const int known = std::min(level, pyramid.levels());
  const float side = power_of_two(-known);
  const float u = (static_cast<float>(x >> (level - known)) + 0.5F) * side;
  const float v = (static_cast<float>(y >> (level - known)) + 0.5F) * side;
  Float4 square = pyramid.lookup(entry, known, u, v);
  if (level >= pyramid.levels() && known > 0)
    square[3] = power_of_two(known - 1 - level) * pyramid.lookup(entry, known - 1, u, v)[3];
  return square;
}

class Packer {
public:
  explicit Packer(PackedLobes& packed) : m_packed(packed) {}

  void add(const Pyramid& pyramid) {
    for (int entry = 0; entry < pyramid.entries(); ++entry)
      for (int level = 0; level <= m_packed.levels; ++level)
        add_level(pyramid, entry, level);
    m_packed.columns += pyramid.entries();
  }

  void finish() {
    constexpr float largest_half = 32768; // leaves room for rounding
    const float largest = *std::max_element(m_values.begin(), m_values.end());
    m_packed.unit = largest > 0 ? largest / largest_half : 1;
    m_packed.texels.reserve(m_values.size());
    for (const float value : m_values)
      m_packed.texels.push_back(wavelet::float_to_half(value / m_packed.unit));
  }

private:
  void add_level(const Pyramid& pyramid, int entry, int level) {
    const int side = std::min(1 << level, window_side);
    const int first = ((1 << level) - side) / 2;
    for (int y = -1; y <= side; ++y) {
      for (int x = -1; x <= side; ++x) {
        const Float4 square = square_of(pyramid, entry, level, first + x, first + y);
        for (int c = 0; c < 4; ++c)
          m_values.push_back(std::max(square[c], 0.0F));
      }
      m_values.resize(m_values.size() + 4 * static_cast<std::size_t>(window_side - side));
    }
  }

  PackedLobes& m_packed;
  std::vector<float> m_values;
};

} // namespace

PackedLobes pack_lobes(std::span<const std::span<const wavelet::TreeView>> sets) {
  PackedLobes packed;
  for (const auto& trees : sets)
    packed.levels = std::max(packed.levels, std::min(trees.front().levels + 1, finest_lobe_level));
  Packer packer(packed);
  for (const auto& trees : sets)
    packer.add(Pyramid(trees));
  packer.finish();
  return packed;
}

} // namespace haarlight::view
