#pragma once

#include "sandbox/reproduce/papers.hpp"

/// One function for each paper, in a file of its own; papers.cpp lists them.
namespace pellucid::sandbox {

using Words = std::string_view;

Paper geocube_paper();
Paper sampling_hulls_paper();
Paper distance_impostors_paper();

}  // namespace pellucid::sandbox
