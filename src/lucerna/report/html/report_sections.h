// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "lucerna/report/html/html_page.h"
#include "lucerna/report/html/report_parts.h"
#include "lucerna/report/html/scene3d.h"

namespace lucerna {

/// The ledger of a trace as a bar and a table.
std::string energy_balance_html(const ResultFigures& result);

/// What the 3D view shows: a scene, or why there is none (plain text).
struct ViewSource {
  const Scene* scene = nullptr;  ///< not owned
  std::string no_scene = "the project was not read";
  Scene3dOptions options{};
};

/// The section "view": the 3D view with its data and scripts.
void add_view_section(HtmlPage& page, const ViewSource& view);

/// The folder's name, for the title.
std::string folder_title(const std::filesystem::path& folder);

}  // namespace lucerna
