#include "sandbox/reproduce/papers.hpp"

#include <algorithm>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "algorithms/parameters.hpp"
#include "gl/error.hpp"
#include "sandbox/reproduce/paper_list.hpp"

namespace pellucid::sandbox {

std::span<const Paper> papers() {
  static const std::vector<Paper> kPapers{geocube_paper(), distance_impostors_paper(), sampling_hulls_paper()};
  return kPapers;
}

const Paper& find_paper(std::string_view name, std::span<const std::string_view> also) {
  std::vector<std::string> names;
  for (const Paper& paper : papers()) {
    if (paper.name == name) return paper;
    names.emplace_back(paper.name);
  }
  names.insert(names.end(), also.begin(), also.end());
  const std::string near = nearest_name(name, names);
  throw InputError(near.empty() ? fmt::format("unknown paper '{}'; one of {}", name, fmt::join(names, ", "))
                                : fmt::format("unknown paper '{}'; did you mean '{}'?", name, near));
}

}  // namespace pellucid::sandbox
