// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

/// Texts that every report carries, built into the library by cmake/EmbedText.cmake.
namespace lucerna::assets {

/// report/assets/report.css: the style, light and dark, screen and paper.
extern const std::string_view report_css;
/// report/assets/report.js: what all scripts share: data, colours, saving, theme, printing.
extern const std::string_view report_js;
/// report/assets/plots.js: values under the cursor of the library's diagrams; needs `report_js` before it.
extern const std::string_view plots_js;
/// report/assets/far_field_map.js: false-colour maps of far fields; needs `report_js` before it.
extern const std::string_view far_field_map_js;
/// report/assets/model_view.js: luminance of an embedded source model; needs `report_js` before it.
extern const std::string_view model_view_js;
/// report/assets/scene3d.js: the 3D view; needs `report_js` and `three_js` before it.
extern const std::string_view scene3d_js;
/// third_party/three: the part of three.js that is used, as the global THREE, with its licence.
extern const std::string_view three_js;

}  // namespace lucerna::assets
