#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include "gl/error.hpp"

namespace pellucid {

/// A glTF 2.0 document with its buffers ("glTF 2.0 Specification", Khronos 2021). Every index, length and type is
/// checked where it is used, each error an InputError.
class GltfFile {
 public:
  GltfFile(const std::filesystem::path&, std::string content, bool binary);

  const nlohmann::json& document() const { return document_; }
  const std::vector<std::filesystem::path>& files() const { return files_; }  ///< buffers that lie in files

  /// The object `list[index]`; `by` says who refers to it.
  const nlohmann::json& object(const char* list, const nlohmann::json& index, std::string_view by) const;
  /// A non-negative integer member; `otherwise` without it.
  std::uint64_t integer(const nlohmann::json& object, const char* key, std::uint64_t otherwise,
                        std::string_view of) const;
  std::uint64_t required_integer(const nlohmann::json& object, const char* key, std::string_view of) const;

  /// An accessor's numbers, `components` for each of its elements, as doubles: normalised integers become [0, 1] or
  /// [−1, 1] (3.6.2.2), sparse elements are in their places (3.6.2.3). Throws when its type has other components.
  std::vector<double> numbers(const nlohmann::json& accessor_index, std::size_t components,
                              std::string_view what) const;
  /// An accessor of unsigned integers: indices.
  std::vector<std::uint32_t> indices(const nlohmann::json& accessor_index) const;

  [[noreturn]] void fail(std::string_view reason) const;

 private:
  struct Component {
    std::size_t bytes = 0;
    double least = 0, most = 0;  ///< of an integer; both 0 for a float
  };
  Component component(const nlohmann::json& object, std::string_view of) const;
  std::vector<double> stored(const nlohmann::json& view_index, std::uint64_t offset, std::uint64_t count,
                             std::size_t components, const Component&, bool normalized, std::string_view of) const;
  void read_container(std::string_view content);
  void read_document(std::string_view text);
  void check_extensions() const;
  void read_buffers();
  std::string buffer_content(const nlohmann::json& buffer, std::size_t number);
  std::string file_content(const std::string& uri, std::uint64_t length);

  std::filesystem::path path_;
  nlohmann::json document_;
  std::string binary_;  ///< GLB's own buffer
  bool has_binary_ = false;
  std::vector<std::string> buffers_;
  std::vector<std::filesystem::path> files_;
};

}  // namespace pellucid
