// SPDX-License-Identifier: Apache-2.0
/// The colour configuration that is used when neither the user nor the scene names one.
#pragma once

namespace lucerna {

/// Needs no file beside it: everything is made of transforms that OpenColorIO 2.1 knows. The
/// names are those of the ASWF's CG config, so scenes keep their meaning under that config.
/// Scene reference: ACES2065-1. Display reference: CIE XYZ under D65.
inline constexpr const char* builtin_ocio = R"ocio(ocio_profile_version: 2
description: Lucerna's own configuration
strictparsing: true

roles:
  default: Linear Rec.709 (sRGB)
  scene_linear: Linear Rec.709 (sRGB)
  rendering: Linear Rec.709 (sRGB)
  aces_interchange: ACES2065-1
  cie_xyz_d65_interchange: CIE-XYZ-D65
  data: Raw
  color_picking: sRGB - Texture
  texture_paint: sRGB - Texture
  matte_paint: sRGB - Texture
  compositing_log: ACEScct

file_rules:
  - !<Rule> {name: openexr, extension: "exr", pattern: "*", colorspace: "Linear Rec.709 (sRGB)"}
  - !<Rule> {name: radiance, extension: "hdr", pattern: "*", colorspace: "Linear Rec.709 (sRGB)"}
  - !<Rule> {name: Default, colorspace: "sRGB - Texture"}

shared_views:
  - !<View>
    name: Un-tone-mapped
    view_transform: Un-tone-mapped
    display_colorspace: <USE_DISPLAY_NAME>
  - !<View>
    name: ACES 1.0 - SDR Video
    view_transform: ACES 1.0 - SDR Video
    display_colorspace: <USE_DISPLAY_NAME>
  - !<View> {name: Raw, colorspace: Raw}

displays:
  sRGB - Display:
    - !<Views> [Un-tone-mapped, ACES 1.0 - SDR Video, Raw]
  Rec.1886 Rec.709 - Display:
    - !<Views> [Un-tone-mapped, ACES 1.0 - SDR Video, Raw]

active_displays: []
active_views: []
default_view_transform: Un-tone-mapped

view_transforms:
  - !<ViewTransform>
    name: Un-tone-mapped
    from_scene_reference: !<BuiltinTransform> {style: UTILITY - ACES-AP0_to_CIE-XYZ-D65_BFD}
  - !<ViewTransform>
    name: ACES 1.0 - SDR Video
    from_scene_reference: !<BuiltinTransform>
      style: ACES-OUTPUT - ACES2065-1_to_CIE-XYZ-D65 - SDR-VIDEO_1.0

display_colorspaces:
  - !<ColorSpace> {name: CIE-XYZ-D65, isdata: false}
  - !<ColorSpace>
    name: sRGB - Display
    isdata: false
    from_display_reference: !<BuiltinTransform> {style: DISPLAY - CIE-XYZ-D65_to_sRGB}
  - !<ColorSpace>
    name: Rec.1886 Rec.709 - Display
    isdata: false
    from_display_reference: !<BuiltinTransform> {style: DISPLAY - CIE-XYZ-D65_to_REC.1886-REC.709}

colorspaces:
  - !<ColorSpace> {name: ACES2065-1, aliases: [aces2065_1, lin_ap0], isdata: false}
  - !<ColorSpace>
    name: ACEScg
    aliases: [acescg, lin_ap1, lin_ap1_scene]
    isdata: false
    to_scene_reference: !<BuiltinTransform> {style: ACEScg_to_ACES2065-1}
  - !<ColorSpace>
    name: ACEScct
    aliases: [acescct]
    isdata: false
    to_scene_reference: !<BuiltinTransform> {style: ACEScct_to_ACES2065-1}
  - !<ColorSpace>
    name: Linear Rec.709 (sRGB)
    aliases: [lin_rec709, lin_rec709_srgb, lin_rec709_scene, lin_srgb, linear,
              Utility - Linear - sRGB]
    isdata: false
    from_scene_reference: !<GroupTransform>
      children:
        - !<BuiltinTransform> {style: ACEScg_to_ACES2065-1, direction: inverse}
        - !<BuiltinTransform> {style: UTILITY - ACES-AP1_to_LINEAR-REC709_BFD}
  - !<ColorSpace>
    name: sRGB - Texture
    aliases: [srgb_tx, srgb_texture, srgb, sRGB, Utility - sRGB - Texture]
    isdata: false
    from_scene_reference: !<GroupTransform>
      children:
        - !<BuiltinTransform> {style: ACEScg_to_ACES2065-1, direction: inverse}
        - !<BuiltinTransform> {style: UTILITY - ACES-AP1_to_LINEAR-REC709_BFD}
        - !<ExponentWithLinearTransform>
          gamma: [2.4, 2.4, 2.4, 1]
          offset: [0.055, 0.055, 0.055, 0]
          direction: inverse
  - !<ColorSpace>
    name: Gamma 2.2 Rec.709 - Texture
    aliases: [g22_rec709, gamma22]
    isdata: false
    from_scene_reference: !<GroupTransform>
      children:
        - !<BuiltinTransform> {style: ACEScg_to_ACES2065-1, direction: inverse}
        - !<BuiltinTransform> {style: UTILITY - ACES-AP1_to_LINEAR-REC709_BFD}
        - !<ExponentTransform> {value: [2.2, 2.2, 2.2, 1], direction: inverse}
  - !<ColorSpace>
    name: Raw
    aliases: [raw, Utility - Raw]
    isdata: true
)ocio";

}  // namespace lucerna
