#pragma once
// From a file to a probe in one call.

#include <probe/probe.h>
#include <probe/read_image.h>

#include <wavelet/file/provenance.h>

#include <optional>
#include <string>
#include <vector>

namespace haarlight::probe {

/// Which mapping a picture has, and a sentence saying why.
struct DetectedMapping {
  Mapping mapping = Mapping::Angular;
  std::string reason;
};

/// Judges by aspect, and where that leaves a choice by content: 2:1 is latlong; a square picture is
/// octahedral if its corners are not empty and its edges are folded onto themselves, else angular.
/// A mirror ball cannot be told from an angular map by its looks and is never taken.
/// @throws Error(Input) if the aspect is neither 2:1 nor 1:1
DetectedMapping detect_mapping(const Image& image, const std::string& path = {});

/// A probe and what is known of its origin.
struct LoadedProbe {
  Probe probe;
  std::string mapping_reason;     ///< a sentence: the mapping taken, and why
  std::vector<std::string> notes; ///< what was changed on reading
  Provenance source;              ///< source (base name), source_hash, mapping
};

/// @param mapping nothing = detect_mapping
/// @throws Error(Input) as read_image, detect_mapping and Probe do
LoadedProbe read_probe(const std::string& path, std::optional<Mapping> mapping = std::nullopt,
                       Lookup lookup = Lookup::Nearest, const ImageChoice& choice = {});

} // namespace haarlight::probe
