#include "sandbox/papers.hpp"

#include <algorithm>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "algorithms/parameters.hpp"
#include "gl/error.hpp"

namespace pellucid::sandbox {
namespace {

using Words = std::string_view;

// ---- sampling hulls: Imagire et al. 2007 ----

constexpr Words kHullsSpecs[] = {"sampling_hulls_table1", "sampling_hulls_curves"};
constexpr Words kHullsPreviews[] = {"sampling_hulls_table1_preview", "sampling_hulls_curves_preview"};

constexpr Words k2x4[] = {"hulls=2", "samples=4"};
constexpr Words k4x8[] = {"hulls=4", "samples=8"};
constexpr Words k4x8Floats[] = {"hulls=4", "samples=8", "coordinates=single"};
constexpr Words k128[] = {"slices=128"};
constexpr Words k32[] = {"slices=32"};
constexpr PaperPicture kFig8[] = {
    {"a_hulls_2x4", "(a)", "sampling_hulls", k2x4, "The fewest samples that the paper shows."},
    {"b_hulls_4x8", "(b)", "sampling_hulls", k4x8, "The fastest column of the paper's Table 1."},
    {"c_slices_128", "(c)", "volume_slices", k128, "The slice-based method, at the paper's count of slices."},
    {"hulls_4x8_floats", "", "sampling_hulls", k4x8Floats,
     "Not in the paper: (b) without the steps that 8 bits leave in the local-coordinates map."},
    {"slices_32", "", "volume_slices", k32,
     "Not in the paper: as many samples along a ray as (b), where slices show their stripes plainly."},
};
constexpr PaperPictures kHullsPictures[] = {{.name = "fig8",
                                             .title = "Fig. 8: a foggy forest",
                                             .scene = "fog_forest",
                                             .view = "",
                                             .width = 720,
                                             .height = 540,
                                             .pictures = kFig8,
                                             .close_up_of = "c_slices_128",
                                             .close_up_width = 160,
                                             .close_up_height = 120}};

constexpr Paper kPapers[] = {
    {"sampling_hulls",
     "Imagire, Johan, Tamura, Nishita 2007: Anti-aliased and real-time rendering of scenes with light "
     "scattering effects",
     "imagire2007", kHullsSpecs, kHullsPreviews, kHullsPictures},
};

}  // namespace

std::span<const Paper> papers() {
  return kPapers;
}

const Paper& find_paper(std::string_view name, std::span<const std::string_view> also) {
  std::vector<std::string> names;
  for (const Paper& paper : kPapers) {
    if (paper.name == name) return paper;
    names.emplace_back(paper.name);
  }
  names.insert(names.end(), also.begin(), also.end());
  const std::string near = nearest_name(name, names);
  throw InputError(near.empty() ? fmt::format("unknown paper '{}'; one of {}", name, fmt::join(names, ", "))
                                : fmt::format("unknown paper '{}'; did you mean '{}'?", name, near));
}

}  // namespace pellucid::sandbox
