#pragma once
// A sheet of images, each under a caption.

#include <wavelet/base/image.h>

#include <string>
#include <vector>

namespace haarlight::image {

struct SheetEntry {
  Image picture;
  std::string caption; ///< ASCII; characters that the font lacks appear as blanks
};

struct SheetOptions {
  int columns = 0; ///< pictures per row; 0 = as square a sheet as possible
  int scale = 1;   ///< pixels per pixel of the 5 × 7 font
  int margin = 4;  ///< pixels between pictures
};

/// Cells are as large as the largest picture; captions are cut to the cell's width.
/// @param entries at least one
Image contact_sheet(const std::vector<SheetEntry>& entries, const SheetOptions& options = {});

/// Draws one line of text in white, its upper left corner at (x, y); cut at `right` and at the
/// picture's edges. A character takes 6 × 8 font pixels.
void draw_text(Image& picture, int x, int y, int right, int scale, const std::string& text);

} // namespace haarlight::image
