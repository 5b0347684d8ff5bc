// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lucerna/report/html/html_page.h"
#include "lucerna/report/html/report_parts.h"
#include "lucerna/results/folders/trace_folder.h"
#include "lucerna/results/svg/svg_axes.h"

namespace lucerna {

/// A far field that the page's scripts know.
struct FarFieldFigure {
  std::size_t index = 0;                ///< in the page's list "far-fields"
  bool thinned = false;                 ///< the page has only some directions of the grid
  std::optional<std::size_t> target{};  ///< the far field it is compared with
};

/// Puts a field's values into the page as float32, thinned to at most 27 k directions.
FarFieldFigure add_far_field(HtmlPage& page, const FarFieldTable& field);

/// Every diagram of a far field; `drawn`: the figures that are written into them.
std::string intensity_plots(const FarFieldTable& field, const FarFieldFigure& figure,
                            const DrawnFigures& drawn);

/// The false-colour map alone: with a target it shows the target and the difference too.
std::string direction_map(const std::string& name, const FarFieldFigure& figure);

/// The pointer of the first far field among a result's detectors; "" if there is none.
std::string first_far_field_key(const ResultFigures& result);

/// The card of a detector's peak: intensity with its error, and where it is as far as that is determined.
std::string peak_card(const ResultFigures& result, const std::string& detector);

/// Summary cards of the far field at the pointer `detector`.
std::string far_field_cards(const ResultFigures& result, const std::string& detector);

/// Diagrams, beam angles and zonal flux of all far fields of a trace. `fields` as in TraceFolder.
void add_far_field_sections(HtmlPage& page, const ResultFigures& result,
                            const std::vector<FarFieldTable>& fields);

}  // namespace lucerna
