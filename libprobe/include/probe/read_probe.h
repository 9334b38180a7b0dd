#pragma once
// From files to images and probes.

#include <probe/probe.h>

#include <wavelet/base/image.h>
#include <wavelet/file/provenance.h>

#include <optional>
#include <string>
#include <vector>

namespace haarlight::probe {

/// A picture and what an output made from it should say of its origin.
struct LoadedImage {
  Image image;
  std::string name;               ///< base name of the file
  std::string hash;               ///< of its bytes, 16 hexadecimal digits
  std::vector<std::string> notes; ///< what was changed on reading, a sentence each
};

/// Which image of a file with several is meant; empty texts leave the choice to the reader.
struct ImageChoice {
  std::string layer; ///< OpenEXR: what precedes the last dot of the channel names
  std::string part;  ///< OpenEXR: name or number of a part; TIFF: number of a page; from 0
};

/// Reads Radiance RGBE, OpenEXR, PFM, TIFF, PNG and JPEG, known by their content. Grey becomes RGB;
/// values encoded for display are made linear, other primaries are converted to Rec. 709,
/// orientation tags are obeyed; negative values are set to 0. Notes state what was done. OpenEXR:
/// the data window is placed in the display window. Formats other than RGBE and PFM are decoded by
/// a separate program with limits of memory and time.
/// @throws Error(Input) if the file is missing, of no accepted format, damaged, truncated, too
/// large,
///         ambiguous (several layers or parts hold colours and none is chosen), or holds a NaN or
///         an infinity, whose pixel is named; std::runtime_error if the program cannot be started
LoadedImage read_image(const std::string& path, const ImageChoice& choice = {});

/// What read_image does to pixels: refuses NaN and infinities, clamps negative values.
/// @return values that were negative
/// @throws Error(Input)
std::size_t clean_pixels(Image& image, const std::string& path);

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
