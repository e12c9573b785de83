#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "sweeps/spec/plan.hpp"

namespace pellucid::sandbox {

/// A picture that a sweep kept (the spec's key `keep`), with a small one for the report.
struct KeptPicture {
  std::string text;                          ///< whose it is: technique, scene, settings, size
  std::string repeat;                        ///< a command line that draws it alone
  std::filesystem::path picture, thumbnail;  ///< the latter is a PNG
};

/// The kept pictures of a plan's points that lie beside `store`, in the plan's order. Their thumbnails are made in
/// `folder`, but those that are newer than the picture stay. One that cannot be read is left out, with a line on
/// standard error.
std::vector<KeptPicture> kept_pictures(const sweeps::Plan&, const std::filesystem::path& store,
                                       const std::filesystem::path& folder);

}  // namespace pellucid::sandbox
