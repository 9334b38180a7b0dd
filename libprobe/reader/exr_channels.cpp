#include "exr_channels.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfPartType.h>

#include <algorithm>
#include <charconv>
#include <functional>
#include <optional>

namespace haarlight::probe::reader {
namespace {

constexpr const char* advice = "choose one by layer or part";

/// Longest list of layers in a message.
constexpr std::size_t longest_list = 600;

std::string lower_case(std::string text) {
  for (char& c : text)
    c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return text;
}

struct Layer {
  ExrChannels channels;
  std::string part_name;
  bool deep = false;
  bool has_x = false;             ///< then Y is a coordinate, not a luminance
  std::vector<std::string> names; ///< of its channels, without the layer

  bool has_colours() const {
    return !deep && !channels.red.empty() && !channels.green.empty() && !channels.blue.empty();
  }
  bool has_luminance() const { return !deep && !channels.luminance.empty() && !has_x; }
};

/// The role of a channel; nullptr if it has none.
std::string* role(ExrChannels& channels, const std::string& name) {
  const std::string lower = lower_case(name);
  if (lower == "r" || lower == "red")
    return &channels.red;
  if (lower == "g" || lower == "green")
    return &channels.green;
  if (lower == "b" || lower == "blue")
    return &channels.blue;
  if (lower == "y")
    return &channels.luminance;
  if (lower == "ry")
    return &channels.red_chroma;
  if (lower == "by")
    return &channels.blue_chroma;
  return nullptr;
}

void add_channel(Layer& layer, const std::string& full_name, const std::string& name) {
  layer.names.push_back(name);
  layer.has_x = layer.has_x || lower_case(name) == "x";
  std::string* place = role(layer.channels, name);
  if (place == nullptr)
    return;
  if (!place->empty() && lower_case(*place) == lower_case(full_name))
    throw Refusal("has the channels " + *place + " and " + full_name +
                  ", which differ in letter case only");
  if (place->empty() || name.size() < 3) // R rather than Red
    *place = full_name;
}

std::vector<Layer> layers_of_part(const Imf::Header& header, int part) {
  std::vector<Layer> layers;
  for (auto i = header.channels().begin(); i != header.channels().end(); ++i) {
    const std::string full_name = i.name();
    const auto dot = full_name.rfind('.');
    const std::string layer = dot == std::string::npos ? "" : full_name.substr(0, dot);
    auto found = std::find_if(layers.begin(), layers.end(),
                              [&](const Layer& l) { return l.channels.layer == layer; });
    if (found == layers.end()) {
      Layer added;
      added.channels.part = part;
      added.channels.layer = layer;
      added.part_name = header.hasName() ? header.name() : "";
      added.deep = header.hasType() && Imf::isDeepData(header.type());
      layers.push_back(added);
      found = layers.end() - 1;
    }
    add_channel(*found, full_name,
                dot == std::string::npos ? full_name : full_name.substr(dot + 1));
  }
  return layers;
}

std::string list(const std::vector<Layer>& layers, bool name_parts) {
  std::string text;
  for (const Layer& layer : layers) {
    if (text.size() > longest_list)
      return text + "; …";
    text += text.empty() ? "" : "; ";
    if (name_parts) {
      text += "part " + std::to_string(layer.channels.part);
      if (!layer.part_name.empty())
        text += " '" + layer.part_name + "'";
      text += layer.deep ? " (deep) " : " ";
    }
    if (!layer.channels.layer.empty())
      text += "layer '" + layer.channels.layer + "' ";
    text += "channels";
    for (std::size_t i = 0; i < layer.names.size(); ++i)
      text += (i > 0 ? ", " : " ") + layer.names[i].substr(0, 64);
  }
  return text;
}

/// The part a user names by its name or else by its number.
int chosen_part(const Imf::MultiPartInputFile& file, const std::string& choice) {
  for (int part = 0; part < file.parts(); ++part)
    if (file.header(part).hasName() && file.header(part).name() == choice)
      return part;
  int number = -1;
  const auto [end, error] = std::from_chars(choice.data(), choice.data() + choice.size(), number);
  if (error == std::errc{} && end == choice.data() + choice.size() && number >= 0 &&
      number < file.parts())
    return number;
  std::string names;
  for (int part = 0; part < file.parts() && names.size() < longest_list; ++part)
    names += (part > 0 ? ", " : "") + std::to_string(part) +
             (file.header(part).hasName() ? " '" + file.header(part).name() + "'" : "");
  throw Refusal("has no part '" + choice + "', its parts are " + names);
}

/// Keeps the layers of a name: in the same letter case, else in any. A part's name counts for its
/// channels without a layer.
void keep_layer(std::vector<Layer>& layers, const std::string& choice) {
  const auto is_named = [&](const Layer& layer, bool any_case) {
    const std::string& name = layer.channels.layer.empty() ? layer.part_name : layer.channels.layer;
    return any_case ? lower_case(name) == lower_case(choice) : name == choice;
  };
  for (const bool any_case : {false, true}) {
    std::vector<Layer> kept;
    for (const Layer& layer : layers)
      if (is_named(layer, any_case))
        kept.push_back(layer);
    if (!kept.empty()) {
      layers = std::move(kept);
      return;
    }
  }
  layers.clear();
}

using Condition = std::function<bool(const Layer&)>;

/// The conditions a layer may meet, the most preferred first.
std::vector<Condition> preferences(bool layer_chosen) {
  const Condition colours = [](const Layer& l) { return l.has_colours(); };
  const Condition luminance = [](const Layer& l) { return l.has_luminance(); };
  if (layer_chosen)
    return {colours, luminance};
  const auto without_layer = [](const Condition& condition) {
    return [condition](const Layer& l) { return l.channels.layer.empty() && condition(l); };
  };
  return {without_layer(colours), colours, without_layer(luminance), luminance};
}

} // namespace

ExrChannels find_colours(const Imf::MultiPartInputFile& file, const ImageChoice& choice) {
  const int only_part = choice.part.empty() ? -1 : chosen_part(file, choice.part);
  std::vector<Layer> layers;
  for (int part = 0; part < file.parts(); ++part)
    if (only_part < 0 || part == only_part)
      for (Layer& layer : layers_of_part(file.header(part), part))
        layers.push_back(std::move(layer));
  const std::string all = list(layers, file.parts() > 1);
  if (!choice.layer.empty())
    keep_layer(layers, choice.layer);
  if (layers.empty())
    throw Refusal("has no layer '" + choice.layer + "', it has " + all);
  for (const Condition& condition : preferences(!choice.layer.empty())) {
    std::vector<Layer> met;
    std::copy_if(layers.begin(), layers.end(), std::back_inserter(met), condition);
    if (met.size() > 1)
      throw Refusal("has several colour images, " + std::string(advice) + ": " +
                    list(met, file.parts() > 1));
    if (met.size() == 1)
      return met.front().channels;
  }
  const bool deep =
      std::any_of(layers.begin(), layers.end(), [](const Layer& l) { return l.deep; });
  throw Refusal(std::string("has no layer of the channels R, G, B or Y") +
                (deep ? ", and deep parts are not read" : "") + ": it has " + all);
}

} // namespace haarlight::probe::reader
