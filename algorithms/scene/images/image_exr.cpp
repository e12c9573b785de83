#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <ImfChannelList.h>
#include <ImfHeader.h>
#include <ImfInputPart.h>
#include <ImfMultiPartInputFile.h>
#include <ImfPartType.h>
#include <ImfStandardAttributes.h>
#include <ImfStringAttribute.h>
#include <ImfTileDescription.h>
#include <fmt/format.h>
#include <glm/glm.hpp>

#include "algorithms/scene/images/chromaticities.hpp"
#include "algorithms/scene/images/exr_slices.hpp"
#include "algorithms/scene/images/image_formats.hpp"

namespace pellucid {

namespace {

// ---- channels and layers ----

/// R, G, B, A first, then the rest by name.
int channel_rank(std::string_view channel) {
  const auto at = std::string_view("RGBA").find(channel);
  return channel.size() == 1 && at != std::string_view::npos ? static_cast<int>(at) : 4;
}

/// The last word of "layer.channel".
std::string_view tail(const std::string& channel) {
  return std::string_view(channel).substr(channel.rfind('.') + 1);
}

/// A flat part's channels by layer; subsampled ones are not read.
struct ExrPart {
  int number = 0;
  std::string name;
  Group main;  ///< R, G, B and perhaps A, or Y
  std::map<std::string, Group> layers;
  std::vector<std::string> subsampled;
};

ExrPart group_channels(const Imf::Header& header, int number) {
  ExrPart part;
  part.number = number;
  part.name = header.hasName() && !header.name().empty() ? header.name() : fmt::format("part{}", number);
  std::set<std::string> plain;
  for (auto it = header.channels().begin(); it != header.channels().end(); ++it) {
    const std::string channel = it.name();
    const auto dot = channel.rfind('.');
    if (it.channel().xSampling != 1 || it.channel().ySampling != 1)
      part.subsampled.push_back(channel);
    else if (dot == std::string::npos)
      plain.insert(channel);
    else
      part.layers[channel.substr(0, dot)].push_back(channel);
  }
  if (plain.contains("R") && plain.contains("G") && plain.contains("B")) {
    part.main = {"R", "G", "B"};
    if (plain.contains("A")) part.main.emplace_back("A");
  } else if (plain.contains("Y")) {
    part.main = {"Y"};
  }
  for (const std::string& channel : part.main)
    plain.erase(channel);
  for (const std::string& channel : plain)
    part.layers[channel].push_back(channel);
  for (auto& [layer, group] : part.layers) {
    std::stable_sort(group.begin(), group.end(), [&](const std::string& a, const std::string& b) {
      return std::pair(channel_rank(tail(a)), tail(a)) < std::pair(channel_rank(tail(b)), tail(b));
    });
  }
  return part;
}

bool is_color(const Group& group) {
  return group.size() >= 3 && tail(group[0]) == "R" && tail(group[1]) == "G" && tail(group[2]) == "B";
}

/// The channels of a file that has no picture: "Z (part 'depth'), N.X".
std::string list_channels(const std::vector<ExrPart>& parts) {
  std::vector<std::string> shown;
  for (const ExrPart& part : parts) {
    std::vector<std::string> names = part.subsampled;
    for (const auto& [layer, group] : part.layers)
      names.insert(names.end(), group.begin(), group.end());
    const std::string all = fmt::format("{}", fmt::join(names, ", "));
    shown.push_back(parts.size() == 1 ? all : fmt::format("{} in part '{}'", all, part.name));
  }
  return fmt::format("{}", fmt::join(shown, "; "));
}

/// Which part and group is the picture: plain R, G, B before plain Y before the only layer of R, G and B. That layer
/// becomes the part's main group.
std::size_t choose_main(const std::filesystem::path& path, std::vector<ExrPart>& parts, PictureFile& result) {
  for (std::size_t i = 0; i < parts.size(); ++i)
    if (parts[i].main.size() >= 3) return i;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (parts[i].main.empty()) continue;
    for (const std::string& channel : parts[i].subsampled) {
      if (channel == "RY" || channel == "BY")
        throw malformed_image(path, "colour as luminance and chroma (Y, RY, BY) is not read");
    }
    return i;
  }
  std::vector<std::pair<std::size_t, std::string>> colored;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    for (const auto& [layer, group] : parts[i].layers)
      if (is_color(group)) colored.emplace_back(i, layer);
  }
  if (colored.empty())
    throw malformed_image(path, fmt::format("no channels R, G, B or Y; it has {}", list_channels(parts)));
  if (colored.size() > 1) {
    std::vector<std::string> names;
    for (const auto& [i, layer] : colored)
      names.push_back(layer);
    throw malformed_image(path, fmt::format("R, G and B lie in the layers {}, and none is the picture by its name",
                                            fmt::join(names, ", ")));
  }
  const auto& [part, layer] = colored.front();
  const auto group = parts[part].layers.extract(layer);
  parts[part].main = group.mapped();
  if (parts[part].main.size() > 4) parts[part].main.resize(4);
  if (parts[part].main.size() == 4 && tail(parts[part].main[3]) != "A") parts[part].main.resize(3);
  result.notes.push_back(fmt::format("layer '{}' is taken for the picture, the only one with R, G and B", layer));
  return part;
}

// ---- the header ----

void read_attributes(const Imf::Header& header, Attributes& attributes) {
  for (auto it = header.begin(); it != header.end(); ++it) {
    const std::string_view key = it.name();
    if (key == "name" || key == "type" || key == "view") continue;  // the format's own
    if (const auto* text = dynamic_cast<const Imf::StringAttribute*>(&it.attribute())) {
      attributes.emplace(key, text->value());
    }
  }
}

PixelWindow window_of(const Imath::Box2i& box) {
  return {box.min.x, box.min.y, box.max.x, box.max.y};
}

/// Rec. 709 from whatever primaries the header names.
void convert_colors(const std::filesystem::path& path, const Imf::Header& header, PictureFile& result) {
  if (!Imf::hasChromaticities(header) || result.image.channels < 3) return;
  const Imf::Chromaticities& named = Imf::chromaticities(header);
  const auto xy = [](const Imath::V2f& v) { return glm::dvec2(v.x, v.y); };
  const Chromaticities from{xy(named.red), xy(named.green), xy(named.blue), xy(named.white)};
  if (from.same_as(Chromaticities{})) return;
  try {
    convert(result.image, to_rec709(from));
  } catch (const InputError& error) {
    throw malformed_image(path, error.what());
  }
  result.notes.push_back(fmt::format(
      "converted to Rec. 709 from primaries ({:.4g}, {:.4g}), ({:.4g}, {:.4g}), ({:.4g}, {:.4g}) and white ({:.4g}, "
      "{:.4g})",
      from.red.x, from.red.y, from.green.x, from.green.y, from.blue.x, from.blue.y, from.white.x, from.white.y));
}

// ---- pixels ----

glm::ivec2 size_of(const Imath::Box2i& box) {
  return {box.max.x - box.min.x + 1, box.max.y - box.min.y + 1};
}

/// Reads the rows of `window`, which is as wide as the data window; an image for each group.
std::vector<Image> read_rows(Imf::InputPart& part, const Imath::Box2i& window, const std::vector<Group>& groups) {
  const glm::ivec2 size = size_of(window);
  std::vector<Image> images;
  Imf::FrameBuffer frame;
  for (const Group& group : groups) {
    const Image& image = images.emplace_back(size.x, size.y, static_cast<int>(group.size()));
    add_slices(frame, window, image.pixels.data(), group);
  }
  part.setFrameBuffer(frame);
  part.readPixels(window.min.y, window.max.y);
  return images;
}

/// Reads the groups of one part into its display window, 0 around what is stored; images in the order of `groups`.
/// Where the windows differ, some rows at a time are read and laid there.
std::vector<Image> read_groups(Imf::MultiPartInputFile& file, int number, const std::vector<Group>& groups,
                               PixelMemory& memory) {
  const Imath::Box2i data = file.header(number).dataWindow(), display = file.header(number).displayWindow();
  std::size_t channels = 0;
  for (const Group& group : groups)
    channels += group.size();
  const glm::ivec2 size = size_of(display);
  memory.take(size.x, size.y, channels);
  Imf::InputPart part(file, number);
  if (data == display) return read_rows(part, data, groups);

  std::vector<Image> images;
  for (const Group& group : groups)
    images.emplace_back(size.x, size.y, static_cast<int>(group.size()));
  const int left = std::max(data.min.x, display.min.x), right = std::min(data.max.x, display.max.x);
  const int last = std::min(data.max.y, display.max.y);
  constexpr std::size_t kSomePixels = std::size_t{1} << 24;  // values in all channels
  const std::size_t row = static_cast<std::size_t>(size_of(data).x) * channels;
  const int rows = static_cast<int>(std::clamp<std::size_t>(kSomePixels / row, 1, 256));
  for (int y = std::max(data.min.y, display.min.y); y <= last && left <= right; y += rows) {
    const Imath::Box2i some({data.min.x, y}, {data.max.x, std::min(y + rows - 1, last)});
    const std::vector<Image> stored = read_rows(part, some, groups);
    for (std::size_t i = 0; i < images.size(); ++i) {
      const auto count = static_cast<std::size_t>(right - left + 1) * groups[i].size();
      for (int from = 0; from < stored[i].height; ++from)
        std::copy_n(stored[i].at(left - data.min.x, from), count,
                    images[i].at(left - display.min.x, y + from - display.min.y));
    }
  }
  return images;
}

void read_part(Imf::MultiPartInputFile& file, const ExrPart& part, bool is_main, const LayerFilter& wanted,
               PixelMemory& memory, PictureFile& result) {
  const Imf::Header& header = file.header(part.number);
  read_attributes(header, result.attributes);
  std::map<std::string, Group> layers = part.layers;
  if (!is_main && !part.main.empty()) layers.emplace(part.name, part.main);
  std::vector<Group> groups;
  std::vector<Image*> targets;
  if (is_main) {
    groups.push_back(part.main);
    targets.push_back(&result.image);
  }
  for (const auto& [layer, group] : layers) {
    const auto& names = result.layer_names;
    const bool taken = std::find(names.begin(), names.end(), layer) != names.end();
    const std::string name = taken ? part.name + "." + layer : layer;
    result.layer_names.push_back(name);
    if (!wanted(name)) continue;
    groups.push_back(group);
    targets.push_back(&result.layers[name]);
  }
  if (groups.empty()) return;
  std::vector<Image> images = read_groups(file, part.number, groups, memory);
  for (std::size_t i = 0; i < images.size(); ++i)
    *targets[i] = std::move(images[i]);
}

/// The library unpacks a chunk at a time, in all its channels, read or not: a part stays below 128 MiB, or below
/// what deflate can have packed into the file.
void check_stored(const std::filesystem::path& path, const Imf::Header& header, std::uint64_t file_bytes) {
  const std::string what = fmt::format("cannot read image '{}'", path.string());
  for (const Imath::Box2i& box : {header.dataWindow(), header.displayWindow()}) {
    const auto side = [](int low, int high) { return static_cast<long long>(high) - low + 1; };
    check_image_size(side(box.min.x, box.max.x), side(box.min.y, box.max.y), what);
  }
  std::uint64_t pixel_bytes = 0;
  for (auto it = header.channels().begin(); it != header.channels().end(); ++it)
    pixel_bytes += it.channel().type == Imf::HALF ? 2U : 4U;
  const glm::ivec2 size = size_of(header.dataWindow());
  const std::uint64_t stored = pixel_bytes * static_cast<std::uint64_t>(size.x) * static_cast<std::uint64_t>(size.y);
  if (stored > std::max(std::uint64_t{128} << 20, 1032 * file_bytes))
    throw malformed_image(path, fmt::format("{}x{} pixels of {} bytes cannot lie in a file of {} bytes", size.x, size.y,
                                            pixel_bytes, file_bytes));
  if (!header.hasTileDescription()) return;
  const Imf::TileDescription& tile = header.tileDescription();
  const double tile_bytes = static_cast<double>(pixel_bytes) * tile.xSize * tile.ySize;
  if (tile_bytes > static_cast<double>(std::max(std::uint64_t{64} << 20, stored)))
    throw malformed_image(path, fmt::format("its tiles of {}x{} pixels are too large for its {}x{} pixels", tile.xSize,
                                            tile.ySize, size.x, size.y));
}

PictureFile read_parts(const std::filesystem::path& path, std::uint64_t file_bytes, const LayerFilter& wanted) {
  PictureFile result;
  Imf::MultiPartInputFile file(path.c_str());
  std::vector<ExrPart> parts;
  for (int number = 0; number < file.parts(); ++number) {
    const Imf::Header& header = file.header(number);
    if (header.hasType() && Imf::isDeepData(header.type())) continue;
    check_stored(path, header, file_bytes);
    parts.push_back(group_channels(header, number));
  }
  if (parts.empty()) throw malformed_image(path, "it has nothing but deep data; flat images are read");
  if (static_cast<std::size_t>(file.parts()) > parts.size()) result.notes.emplace_back("its deep parts are not read");
  const std::size_t main = choose_main(path, parts, result);
  const Imf::Header& header = file.header(parts[main].number);
  result.data_window = window_of(header.dataWindow());
  result.display_window = window_of(header.displayWindow());
  result.pixel_aspect = static_cast<double>(header.pixelAspectRatio());
  if (Imf::hasEnvmap(header))
    result.envmap = Imf::envmap(header) == Imf::ENVMAP_CUBE ? PictureFile::Envmap::cube : PictureFile::Envmap::lat_long;
  PixelMemory memory(path, file_bytes);
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const bool other_picture = file.header(parts[i].number).displayWindow() != header.displayWindow();
    if (i != main && other_picture) continue;  // no layer of this picture
    read_part(file, parts[i], i == main, wanted, memory, result);
  }
  convert_colors(path, header, result);
  return result;
}

}  // namespace

PictureFile read_exr(const std::filesystem::path& path, std::uint64_t file_bytes, const LayerFilter& wanted) {
  check_exr(path, file_bytes);
  try {
    return read_parts(path, file_bytes, wanted);
  } catch (const InputError&) {
    throw;
  } catch (const std::exception& e) {
    throw malformed_image(path, fmt::format("the OpenEXR file is truncated or damaged: {}", e.what()));
  }
}

}  // namespace pellucid
