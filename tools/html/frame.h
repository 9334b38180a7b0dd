#pragma once
// What all pages begin and end with.

#include <string>

namespace haarlight::html {

/// A whole page, which needs no other file and no network.
/// @param title plain text
/// @param body  HTML
std::string framed(const std::string& title, const std::string& body);

} // namespace haarlight::html
