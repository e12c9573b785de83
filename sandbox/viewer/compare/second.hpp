#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "sandbox/viewer/live/file_watch.hpp"
#include "sandbox/viewer/state/workspace.hpp"

namespace pellucid::sandbox {

/// The picture's counterpart in a comparison.
enum class Against { nothing, technique, reference, file };

/// The second picture: another technique's, the ground truth as it converges in a process of its own, or a file that is
/// read again when it changes.
class Second {
 public:
  Second(Workspace&, std::optional<int> device, std::function<void()> wake);
  /// Throws InputError for a file that cannot be read.
  void choose(Against, const std::filesystem::path& file = {});
  Against against() const { return against_; }
  const std::filesystem::path& file() const { return file_; }
  /// Takes what has come, and asks for the truth of another scene or view; true when the image is another one.
  bool poll();
  /// A reference whose renderer has failed is traced again.
  void again();
  /// Null while there is none.
  const std::shared_ptr<const Image>& image() const { return image_; }
  /// A name, and how far it has converged.
  std::string words() const;
  bool busy() const { return reference_ && reference_->busy(); }

 private:
  void ask_reference();
  Workspace& workspace_;
  std::optional<int> device_;
  std::function<void()> wake_;
  Against against_ = Against::nothing;
  std::filesystem::path file_;
  std::unique_ptr<RenderClient> reference_;
  std::unique_ptr<FileWatch> watch_;
  std::shared_ptr<const Image> image_;
  std::shared_ptr<const Picture> shown_;
  std::optional<ViewState> asked_;
  std::uint64_t generation_ = 0;
  std::string quality_, trouble_;
};

}  // namespace pellucid::sandbox
