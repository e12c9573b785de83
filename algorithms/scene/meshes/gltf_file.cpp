#include "algorithms/scene/meshes/gltf_file.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstddef>
#include <cstring>
#include <fstream>

#include <fmt/format.h>
#include <nettle/base64.h>

#include "algorithms/scene/meshes/raw_mesh.hpp"

namespace pellucid {

namespace fs = std::filesystem;
using nlohmann::json;

namespace {

/// They say how surfaces look or what a reader may ignore, and leave the geometry as it is.
bool leaves_geometry(std::string_view extension) {
  constexpr std::array kPrefixes = {"KHR_materials_", "KHR_texture_", "EXT_texture_", "MSFT_texture_",
                                    "KHR_lights_",    "EXT_lights_",  "KHR_xmp",      "KHR_techniques_webgl"};
  return std::any_of(kPrefixes.begin(), kPrefixes.end(), [&](const char* p) { return extension.starts_with(p); });
}

std::string percent_decoded(std::string_view uri) {
  std::string out;
  const auto digit = [](char c) {
    return std::isdigit(static_cast<unsigned char>(c)) != 0 ? c - '0' : std::tolower(c) - 'a' + 10;
  };
  const auto hex = [](char c) { return std::isxdigit(static_cast<unsigned char>(c)) != 0; };
  for (std::size_t i = 0; i < uri.size(); ++i) {
    if (uri[i] == '%' && i + 2 < uri.size() && hex(uri[i + 1]) && hex(uri[i + 2])) {
      out += static_cast<char>(digit(uri[i + 1]) * 16 + digit(uri[i + 2]));
      i += 2;
    } else {
      out += uri[i];
    }
  }
  return out;
}

}  // namespace

void GltfFile::fail(std::string_view reason) const {
  throw unreadable_mesh(path_, reason);
}

GltfFile::GltfFile(const fs::path& path, std::string content, bool binary) : path_(path) {
  if (binary)
    read_container(content);
  else
    read_document(content);
  check_extensions();
  read_buffers();
}

void GltfFile::read_container(std::string_view content) {
  const auto number = [&](std::size_t at) {
    std::uint32_t value = 0;
    std::memcpy(&value, content.data() + at, sizeof value);
    return value;
  };
  constexpr std::uint32_t kMagic = 0x46546C67, kJson = 0x4E4F534A, kBin = 0x004E4942;
  if (content.size() < 20 || number(0) != kMagic) fail("it does not begin as a binary glTF file");
  if (number(4) != 2) fail(fmt::format("version {} of binary glTF is not read", number(4)));
  if (number(8) != content.size())
    fail(fmt::format("its header claims {} bytes; it has {}", number(8), content.size()));
  std::string_view text;
  for (std::size_t at = 12; at < content.size();) {
    if (content.size() - at < 8 || number(at) > content.size() - at - 8) fail("a chunk ends too soon");
    const std::string_view chunk = content.substr(at + 8, number(at));
    if (number(at + 4) == kJson && at == 12) text = chunk;
    if (number(at + 4) == kBin && !has_binary_) {
      binary_ = chunk;
      has_binary_ = true;
    }
    at += 8 + chunk.size();
  }
  read_document(text);
}

void GltfFile::read_document(std::string_view text) {
  try {
    document_ = json::parse(text);
  } catch (const json::exception& error) {
    std::string reason = error.what();
    std::replace(reason.begin(), reason.end(), '\n', ' ');
    fail(fmt::format("its JSON is malformed: {}", reason.substr(reason.find("] ") + 2)));
  }
  if (!document_.is_object()) fail("it is no glTF document");
  const auto asset = document_.find("asset");
  if (asset == document_.end() || !asset->is_object() || !asset->contains("version") ||
      !(*asset)["version"].is_string())
    fail("it states no glTF version");
  if (const std::string version = (*asset)["version"]; !version.starts_with("2."))
    fail(fmt::format("glTF {} is not read; 2.0 is", version));
}

void GltfFile::check_extensions() const {
  const auto required = document_.find("extensionsRequired");
  if (required == document_.end()) return;
  if (!required->is_array()) fail("extensionsRequired is no list");
  for (const json& name : *required) {
    const std::string extension = name.is_string() ? name.get<std::string>() : name.dump();
    if (extension == "KHR_mesh_quantization" || extension == "EXT_mesh_gpu_instancing" || leaves_geometry(extension))
      continue;
    fail(fmt::format("it requires the extension {}, which is not supported", extension));
  }
}

void GltfFile::read_buffers() {
  const auto buffers = document_.find("buffers");
  if (buffers == document_.end()) return;
  if (!buffers->is_array()) fail("buffers is no list");
  for (std::size_t i = 0; i < buffers->size(); ++i)
    buffers_.push_back(buffer_content((*buffers)[i], i));
}

std::string GltfFile::buffer_content(const json& buffer, std::size_t number) {
  const std::string shown = fmt::format("buffer {}", number);
  const std::uint64_t length = required_integer(buffer, "byteLength", shown);
  std::string content;
  const auto uri = buffer.find("uri");
  if (uri == buffer.end()) {
    if (number != 0 || !has_binary_) return {};  // a fall-back of a compressed one: an error if it is used
    content = binary_;
  } else if (!uri->is_string()) {
    fail(shown + " has a URI that is no text");
  } else if (const std::string text = *uri; text.starts_with("data:")) {
    const auto comma = text.find(";base64,");
    if (comma == std::string::npos) fail(shown + " is inline data that are not base64");
    const std::string_view packed = std::string_view(text).substr(comma + 8);
    content.resize(BASE64_DECODE_LENGTH(packed.size()));
    base64_decode_ctx context;
    base64_decode_init(&context);
    std::size_t bytes = content.size();
    if (base64_decode_update(&context, &bytes, reinterpret_cast<std::uint8_t*>(content.data()), packed.size(),
                             packed.data()) == 0 ||
        base64_decode_final(&context) == 0)
      fail(shown + " is damaged base64");
    content.resize(bytes);
  } else {
    content = file_content(text, length);
  }
  if (content.size() < length) fail(fmt::format("{} has {} bytes; {} are claimed", shown, content.size(), length));
  content.resize(length);
  return content;
}

/// A URI is percent-encoded; some exporters write the bare name.
std::string GltfFile::file_content(const std::string& uri, std::uint64_t length) {
  if (uri.find("://") != std::string::npos) fail(fmt::format("its buffer '{}' is no file beside it", uri));
  std::error_code error;
  fs::path file = path_.parent_path() / percent_decoded(uri);
  if (!fs::is_regular_file(file, error) && fs::is_regular_file(path_.parent_path() / uri, error))
    file = path_.parent_path() / uri;
  if (!fs::is_regular_file(file, error)) fail(fmt::format("its buffer '{}' is missing", file.string()));
  const std::uintmax_t bytes = fs::file_size(file, error);
  if (bytes < length) fail(fmt::format("its buffer '{}' has {} bytes; {} are claimed", file.string(), bytes, length));
  std::ifstream stream(file, std::ios::binary);
  std::string content(length, '\0');
  if (!stream.read(content.data(), static_cast<std::streamsize>(length)))
    fail(fmt::format("its buffer '{}' cannot be read", file.string()));
  if (std::find(files_.begin(), files_.end(), file) == files_.end()) files_.push_back(file);
  return content;
}

// ---- JSON ----

const json& GltfFile::object(const char* list, const json& index, std::string_view by) const {
  const auto all = document_.find(list);
  const std::size_t count = all != document_.end() && all->is_array() ? all->size() : 0;
  if (!index.is_number_unsigned() || index.get<std::uint64_t>() >= count)
    fail(fmt::format("{} names {}[{}], of which there are {}", by, list, index.dump(), count));
  const json& found = (*all)[index.get<std::size_t>()];
  if (!found.is_object()) fail(fmt::format("{}[{}] is no object", list, index.dump()));
  return found;
}

std::uint64_t GltfFile::integer(const json& object, const char* key, std::uint64_t otherwise,
                                std::string_view of) const {
  if (!object.is_object()) fail(fmt::format("{} is no object", of));
  const auto found = object.find(key);
  if (found == object.end()) return otherwise;
  constexpr std::uint64_t kMost = std::uint64_t{1} << 40;
  if (!found->is_number_unsigned() || found->get<std::uint64_t>() > kMost)
    fail(fmt::format("{} of {} is {}", key, of, found->dump()));
  return found->get<std::uint64_t>();
}

std::uint64_t GltfFile::required_integer(const json& object, const char* key, std::string_view of) const {
  if (!object.is_object() || !object.contains(key)) fail(fmt::format("{} has no {}", of, key));
  return integer(object, key, 0, of);
}

// ---- accessors ----

GltfFile::Component GltfFile::component(const json& object, std::string_view of) const {
  switch (required_integer(object, "componentType", of)) {
    case 5120:
      return {1, -128, 127};
    case 5121:
      return {1, 0, 255};
    case 5122:
      return {2, -32768, 32767};
    case 5123:
      return {2, 0, 65535};
    case 5125:
      return {4, 0, 4294967295.0};
    case 5126:
      return {4, 0, 0};
    default:
      fail(fmt::format("{} has no type that glTF knows", of));
  }
}

namespace {

template <class T>
double number_at(const char* bytes) {
  T value;
  std::memcpy(&value, bytes, sizeof value);
  return static_cast<double>(value);
}

double component_at(const char* bytes, std::size_t size, double least, double most) {
  if (most == 0) return number_at<float>(bytes);
  if (size == 1) return least < 0 ? number_at<std::int8_t>(bytes) : number_at<std::uint8_t>(bytes);
  if (size == 2) return least < 0 ? number_at<std::int16_t>(bytes) : number_at<std::uint16_t>(bytes);
  return number_at<std::uint32_t>(bytes);
}

}  // namespace

std::vector<double> GltfFile::stored(const json& view_index, std::uint64_t offset, std::uint64_t count,
                                     std::size_t components, const Component& type, bool normalized,
                                     std::string_view of) const {
  const json& view = object("bufferViews", view_index, of);
  const json& index = view.contains("buffer") ? view["buffer"] : json();
  object("buffers", index, of);
  const std::string& buffer = buffers_[index.get<std::size_t>()];
  const std::uint64_t begin = integer(view, "byteOffset", 0, of), length = required_integer(view, "byteLength", of);
  const std::uint64_t element = type.bytes * components, stride = integer(view, "byteStride", element, of);
  if (begin > buffer.size() || length > buffer.size() - begin)
    fail(fmt::format("{} lies beyond the end of its buffer", of));
  if (stride < element || stride > 65536) fail(fmt::format("{} has a stride of {} bytes", of, stride));
  if (count > 0 && (offset > length || element > length - offset || (count - 1) > (length - offset - element) / stride))
    fail(fmt::format("{} has {} elements, more than its {} bytes hold", of, count, length));
  std::vector<double> out;
  out.reserve(count * components);
  for (std::uint64_t i = 0; i < count; ++i) {
    const char* at = buffer.data() + begin + offset + i * stride;
    for (std::size_t c = 0; c < components; ++c) {
      const double value = component_at(at + c * type.bytes, type.bytes, type.least, type.most);
      out.push_back(normalized && type.most > 0 ? std::max(value / type.most, -1.0) : value);
    }
  }
  return out;
}

std::vector<double> GltfFile::numbers(const json& accessor_index, std::size_t components, std::string_view what) const {
  const std::string of = fmt::format("the accessor of {}", what);
  const json& accessor = object("accessors", accessor_index, what);
  constexpr std::array<std::string_view, 5> kTypes = {"", "SCALAR", "VEC2", "VEC3", "VEC4"};
  const auto type = accessor.find("type");
  if (type == accessor.end() || *type != kTypes[components])
    fail(fmt::format("{} is not of type {}", of, kTypes[components]));
  const Component component_type = component(accessor, of);
  const std::uint64_t count = required_integer(accessor, "count", of);
  check_mesh_size(path_, count / 3, 0);  // so many indices at most
  const auto normalized = accessor.find("normalized");
  const bool scaled = normalized != accessor.end() && normalized->is_boolean() && normalized->get<bool>();
  std::vector<double> out;
  if (accessor.contains("bufferView")) {
    out = stored(accessor["bufferView"], integer(accessor, "byteOffset", 0, of), count, components, component_type,
                 scaled, of);
  } else if (accessor.contains("sparse")) {
    // A file of a few bytes must not claim gigabytes of zeros.
    if (count > 65536) fail(fmt::format("{} has {} elements and no buffer view", of, count));
    out.assign(count * components, 0.0);
  } else {
    fail(fmt::format("{} has no data (compressed data are not read)", of));
  }
  const auto sparse = accessor.find("sparse");
  if (sparse == accessor.end()) return out;
  const std::uint64_t changed = required_integer(*sparse, "count", of);
  if (!sparse->contains("indices") || !sparse->contains("values"))
    fail(fmt::format("{} is sparse without indices or values", of));
  const json& places = (*sparse)["indices"];
  const json& values = (*sparse)["values"];
  if (!places.is_object() || !values.is_object() || !places.contains("bufferView") || !values.contains("bufferView"))
    fail(fmt::format("{} is sparse without indices or values", of));
  const std::vector<double> at =
      stored(places["bufferView"], integer(places, "byteOffset", 0, of), changed, 1, component(places, of), false, of);
  const std::vector<double> to = stored(values["bufferView"], integer(values, "byteOffset", 0, of), changed, components,
                                        component_type, scaled, of);
  for (std::size_t i = 0; i < at.size(); ++i) {
    if (!(at[i] >= 0 && at[i] < static_cast<double>(count)))
      fail(fmt::format("{} has a sparse element {} of {}", of, at[i], count));
    std::copy_n(to.begin() + static_cast<std::ptrdiff_t>(i * components), components,
                out.begin() + static_cast<std::ptrdiff_t>(static_cast<std::size_t>(at[i]) * components));
  }
  return out;
}

std::vector<std::uint32_t> GltfFile::indices(const json& accessor_index) const {
  const json& accessor = object("accessors", accessor_index, "a primitive's indices");
  const Component type = component(accessor, "the accessor of indices");
  if (type.least < 0 || type.most == 0) fail("indices are not unsigned integers");
  const std::vector<double> values = numbers(accessor_index, 1, "indices");
  return {values.begin(), values.end()};
}

}  // namespace pellucid
