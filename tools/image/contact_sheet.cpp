#include <image/contact_sheet.h>

#include <image/font.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstring>

namespace haarlight::image {
namespace {

constexpr int advance = 6;
constexpr int line_height = 9;

void fill_square(Picture& picture, int left, int top, int side, int right) {
  for (int y = std::max(top, 0); y < std::min(top + side, picture.height); ++y)
    for (int x = std::max(left, 0); x < std::min({left + side, picture.width, right}); ++x)
      picture.set(x, y, Rgb::Ones());
}

void draw_glyph(Picture& picture, int left, int top, int right, int scale, char character) {
  const Glyph glyph = glyph_of(character);
  for (int row = 0; row < glyph_height; ++row)
    for (int column = 0; column < glyph_width; ++column)
      if (glyph.pixel(column, row))
        fill_square(picture, left + column * scale, top + row * scale, scale, right);
}

void paste(const Picture& part, Picture& whole, int left, int top) {
  for (int y = 0; y < part.height; ++y)
    std::copy_n(part.rgb.begin() + static_cast<std::ptrdiff_t>(part.offset(0, y)), 3 * part.width,
                whole.rgb.begin() + static_cast<std::ptrdiff_t>(whole.offset(left, top + y)));
}

int column_count(const SheetOptions& options, std::size_t entries) {
  const int count = static_cast<int>(entries);
  if (options.columns > 0)
    return std::min(options.columns, count);
  int columns = 1;
  while (columns * columns < count)
    ++columns;
  return columns;
}

} // namespace

void draw_text(Picture& picture, int x, int y, int right, int scale, const std::string& text) {
  for (const char character : text) {
    draw_glyph(picture, x, y, right, scale, character);
    x += advance * scale;
  }
}

Picture contact_sheet(const std::vector<SheetEntry>& entries, const SheetOptions& options) {
  assert(!entries.empty());
  int width = 0;
  int height = 0;
  for (const SheetEntry& entry : entries) {
    width = std::max(width, entry.picture.width);
    height = std::max(height, entry.picture.height);
  }
  const int columns = column_count(options, entries.size());
  const int rows = (static_cast<int>(entries.size()) + columns - 1) / columns;
  const int step_x = width + options.margin;
  const int step_y = height + options.margin + line_height * options.scale;
  Picture sheet(columns * step_x + options.margin, rows * step_y + options.margin);
  std::fill(sheet.rgb.begin(), sheet.rgb.end(), 0.02F);
  for (int i = 0; i < static_cast<int>(entries.size()); ++i) {
    const SheetEntry& entry = entries[static_cast<std::size_t>(i)];
    const int left = options.margin + (i % columns) * step_x;
    const int top = options.margin + (i / columns) * step_y;
    draw_text(sheet, left, top, left + width, options.scale, entry.caption);
    paste(entry.picture, sheet, left, top + line_height * options.scale);
  }
  return sheet;
}

} // namespace haarlight::image
