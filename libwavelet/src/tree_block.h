#pragma once
// Some consecutive trees of a set as one block of a packed file.

#include "file_rules.h"

#include <wavelet/tree.h>

#include <span>
#include <vector>

namespace haarlight::wavelet {

/// @param trees of one set, within the bounds of <packed_layout.h>
std::vector<std::byte> encode_block(std::span<const Tree> trees);

/// @param block  a whole block
/// @param set    a checked header: levels, channels and type of the trees
/// @param rules  names the file in errors
/// @param offset of the block in the file
/// @throws Error(Input) at the first broken rule; nothing is allocated before its size is checked
std::vector<Tree> decode_block(std::span<const std::byte> block, const FileHeader& set,
                               const FileRules& rules, std::uint64_t offset);

} // namespace haarlight::wavelet
