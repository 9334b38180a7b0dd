#pragma once
// Numbers and words in HTML.

#include <string>

namespace haarlight::html {

/// A text's &, <, > and quotes made harmless; control characters become U+FFFD.
std::string escaped(const std::string& text);

/// Three significant digits, as in 0.00123 or 1.5 × 10⁻⁷ in HTML; a dash for what is unknown.
std::string number_html(double number);

/// Four decimals, as in 0.9987; a dash for what is unknown.
std::string ratio_html(double number);

/// Fixed point, for coordinates.
std::string fixed(double number);

} // namespace haarlight::html
