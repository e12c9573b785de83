#include "algorithms/scene/relief/map_file.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstddef>
#include <string>
#include <string_view>

#include <fmt/format.h>
#include <glm/glm.hpp>
#include <vtkImageData.h>
#include <vtkJPEGReader.h>
#include <vtkNew.h>
#include <vtkTGAReader.h>

#include "algorithms/scene/files/tell.hpp"
#include "gl/error.hpp"

namespace pellucid {
namespace {

InputError refuse(const std::filesystem::path& path, std::string_view reason) {
  return InputError(fmt::format("cannot read map '{}': {}", path.string(), reason));
}

// VTK's rows are from the bottom already.
template <class Reader>
ImageFile load_with_vtk(const std::filesystem::path& path) {
  vtkNew<Reader> reader;
  if (reader->CanReadFile(path.string().c_str()) == 0) throw refuse(path, "it is damaged, or of another format");
  reader->SetFileName(path.string().c_str());
  reader->UpdateInformation();
  const int* extent = reader->GetDataExtent();
  const int width = extent[1] - extent[0] + 1, height = extent[3] - extent[2] + 1;
  check_image_size(width, height, "map '" + path.string() + "'");
  reader->Update();
  vtkImageData* data = reader->GetOutput();
  const int channels = data->GetNumberOfScalarComponents();
  if (reader->GetErrorCode() != 0 || data->GetScalarType() != VTK_UNSIGNED_CHAR || channels < 1 || channels > 4 ||
      data->GetNumberOfPoints() != static_cast<vtkIdType>(width) * height)
    throw refuse(path, "it is damaged");
  ImageFile file;
  file.image = Image(width, height, channels);
  const auto* bytes = static_cast<const unsigned char*>(data->GetScalarPointer());
  std::transform(bytes, bytes + file.image.pixels.size(), file.image.pixels.begin(),
                 [](unsigned char b) { return static_cast<float>(b) / 255.0F; });
  file.display_encoded = true;
  return file;
}

float linear(float encoded) {
  return encoded <= 0.04045F ? encoded / 12.92F : std::pow((encoded + 0.055F) / 1.055F, 2.4F);
}

}  // namespace

ImageFile load_map(const std::filesystem::path& path) {
  std::string kind = path.extension().string();
  std::transform(kind.begin(), kind.end(), kind.begin(), [](unsigned char c) { return std::tolower(c); });
  if (kind == ".tga") return load_with_vtk<vtkTGAReader>(path);
  if (kind == ".jpg" || kind == ".jpeg") return load_with_vtk<vtkJPEGReader>(path);
  ImageFile file = read_image(path);
  Image& image = file.image;
  for (int y = 0; y < image.height / 2; ++y)
    std::swap_ranges(image.at(0, y), image.at(0, y) + image.width * image.channels, image.at(0, image.height - 1 - y));
  return file;
}

Image height_map(const ImageFile& file, MapChannel channel) {
  const Image& image = file.image;
  const int wanted = static_cast<int>(channel);
  if (wanted >= image.channels && !(image.channels == 2 && channel == MapChannel::alpha)) {
    throw InputError(fmt::format("it has {}, and none is {}",
                                 counted(static_cast<std::size_t>(image.channels), "channel"),
                                 std::array{"red", "green", "blue", "alpha"}[static_cast<std::size_t>(wanted)]));
  }
  const int at = std::min(wanted, image.channels - 1);
  Image heights(image.width, image.height, 1);
  for (std::size_t i = 0; i < heights.pixels.size(); ++i) {
    const float value = image.pixels[i * static_cast<std::size_t>(image.channels) + static_cast<std::size_t>(at)];
    if (!(value >= 0.0F && value <= 1.0F))
      throw InputError(fmt::format("it has the height {}, which is outside [0, 1]", value));
    heights.pixels[i] = value;
  }
  return heights;
}

Image normal_map(const ImageFile& file, bool flip_green) {
  const Image& image = file.image;
  if (image.channels < 3) throw InputError("a normal map has three channels");
  Image normals(image.width, image.height, 3);
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const float* in = image.at(x, y);
      glm::vec3 n = 2.0F * glm::vec3(in[0], in[1], in[2]) - 1.0F;
      if (flip_green) n.y = -n.y;
      const float length = glm::length(n);
      if (!(length > 0.1F && length < 2.0F) || !(n.z > 0.0F)) {
        throw InputError(fmt::format("it is no normal map in tangent space: its texel ({}, {}) is ({}, {}, {})", x, y,
                                     in[0], in[1], in[2]));
      }
      std::copy_n(&(n /= length)[0], 3, normals.at(x, y));
    }
  }
  return normals;
}

Image color_map(const ImageFile& file) {
  const Image& image = file.image;
  Image colors(image.width, image.height, 3);
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      for (int c = 0; c < 3; ++c) {
        float value = image.at(x, y)[image.channels >= 3 ? c : 0];
        if (file.display_encoded) value = linear(value);
        if (!(value >= 0.0F && value <= 1.0F))
          throw InputError(fmt::format("it has the colour {}, which is outside [0, 1]", value));
        colors.at(x, y)[c] = value;
      }
    }
  }
  return colors;
}

}  // namespace pellucid
