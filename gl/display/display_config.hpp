#pragma once

#include <string_view>

namespace pellucid::gl {

/// The OpenColorIO config used without $OCIO. Its scene reference is linear Rec. 709, its display sRGB with the views
/// "Film" (ACES 1.0 SDR rendering, the default) and "sRGB" (the sRGB curve alone, no tone mapping: for figures and
/// metrics). Both are built from OpenColorIO's own transforms and need no file.
inline constexpr std::string_view kDisplayConfig = R"(ocio_profile_version: 2

name: pellucid
description: Scene-linear Rec. 709 to an sRGB display.
strictparsing: true
environment: {}
search_path: ""

roles:
  default: lin_rec709
  scene_linear: lin_rec709
  rendering: lin_rec709
  data: raw
  aces_interchange: ACES2065-1
  cie_xyz_d65_interchange: CIE-XYZ-D65

file_rules:
  - !<Rule> {name: Default, colorspace: default}

displays:
  sRGB:
    - !<View> {name: Film, view_transform: ACES SDR, display_colorspace: sRGB}
    - !<View> {name: sRGB, view_transform: Untoned, display_colorspace: sRGB}

active_displays: [sRGB]
active_views: [Film, sRGB]

default_view_transform: Untoned
view_transforms:
  - !<ViewTransform>
    name: ACES SDR
    description: ACES 1.0 output rendering to a 100 nit video display.
    from_scene_reference: !<GroupTransform>
      children:
        - !<MatrixTransform> {matrix: [0.4123907992659595, 0.35758433938387796, 0.1804807884018343, 0, 0.21263900587151036, 0.7151686787677559, 0.07219231536073371, 0, 0.01933081871559185, 0.11919477979462599, 0.9505321522496606, 0, 0, 0, 0, 1]}
        - !<BuiltinTransform> {style: UTILITY - ACES-AP0_to_CIE-XYZ-D65_BFD, direction: inverse}
        - !<BuiltinTransform> {style: ACES-OUTPUT - ACES2065-1_to_CIE-XYZ-D65 - SDR-VIDEO_1.0}
  - !<ViewTransform>
    name: Untoned
    description: Colorimetry as it is, no tone mapping.
    from_scene_reference: !<MatrixTransform> {matrix: [0.4123907992659595, 0.35758433938387796, 0.1804807884018343, 0, 0.21263900587151036, 0.7151686787677559, 0.07219231536073371, 0, 0.01933081871559185, 0.11919477979462599, 0.9505321522496606, 0, 0, 0, 0, 1]}

display_colorspaces:
  - !<ColorSpace>
    name: CIE-XYZ-D65
    description: The display reference.
    isdata: false
  - !<ColorSpace>
    name: sRGB
    description: The sRGB display (IEC 61966-2-1).
    isdata: false
    from_display_reference: !<BuiltinTransform> {style: DISPLAY - CIE-XYZ-D65_to_sRGB}

colorspaces:
  - !<ColorSpace>
    name: lin_rec709
    description: Scene-linear with the primaries of Rec. 709 and D65 white, the reference.
    encoding: scene-linear
    isdata: false
  - !<ColorSpace>
    name: ACES2065-1
    description: The Academy Color Encoding System's interchange space.
    encoding: scene-linear
    isdata: false
    to_scene_reference: !<GroupTransform>
      children:
        - !<BuiltinTransform> {style: UTILITY - ACES-AP0_to_CIE-XYZ-D65_BFD}
        - !<MatrixTransform> {matrix: [0.4123907992659595, 0.35758433938387796, 0.1804807884018343, 0, 0.21263900587151036, 0.7151686787677559, 0.07219231536073371, 0, 0.01933081871559185, 0.11919477979462599, 0.9505321522496606, 0, 0, 0, 0, 1], direction: inverse}
  - !<ColorSpace>
    name: raw
    description: Data, not colour.
    isdata: true
)";

}  // namespace pellucid::gl
