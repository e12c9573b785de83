#pragma once

#include <memory>

#include "algorithms/technique.hpp"

/// Refraction at two interfaces in the space of the screen (Wyman 2005, references.bib: wyman2005), a peer of the
/// geocube: the far side is what the screen shows of it, and the way there a blend of two depths. It refracts the
/// environment alone; other objects are hidden by what stands before them, but not seen through it.
namespace pellucid::screen_space_refraction {

enum class FarSide { farthest, nearest };
enum class TotalReflection { graze, reflect };

struct Parameters {
  FarSide far_side = FarSide::farthest;
  bool normal_depth = true;
  TotalReflection total_reflection = TotalReflection::graze;

  static constexpr void parameters(auto& self, auto&& visit) {
    visit(PARAM(far_side), {.symbol = "N2",
                            .cite = "Wyman 2005, Sec. 3",
                            .doc = "which back-facing surface stands for the far side where several cover a pixel",
                            .choices = "farthest|nearest"});
    visit(PARAM(normal_depth), {.symbol = "d_N",
                                .cite = "Wyman 2005, Sec. 3.1",
                                .doc = "blend the depth along the view ray with that along the inward normal, by the "
                                       "angles before and behind the interface; off: the former alone",
                                .when = Change::program});
    visit(PARAM(total_reflection),
          {.cite = "Wyman 2005, Sec. 3.3",
           .doc = "where nothing leaves the far side: let the ray graze it, or reflect it once and look that way up",
           .when = Change::program,
           .choices = "graze|reflect"});
  }
};
static_assert(well_formed<Parameters>());

const ParameterTable& table();
std::unique_ptr<Technique> make();

}  // namespace pellucid::screen_space_refraction
