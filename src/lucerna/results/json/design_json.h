// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "lucerna/design/lens/lens_design.h"
#include "lucerna/design/run/design_metrics.h"

namespace lucerna {

/// What a design says of its result beside DesignFindings.
struct DesignForm {
  std::size_t parameters = 0;
  double height_mm = 0.0, validation_s = 0.0;
  /// A lens: there are no bound and no mirror's losses.
  bool is_lens = false;
};
DesignForm design_form(const DesignResult& result);
DesignForm design_form(const LensResult& result);

/// What design adds to result.json. What is not known is null.
nlohmann::ordered_json design_json(const DesignTarget& target, const DesignFindings& result,
                                   const DesignForm& form, const DesignMetrics& figures);

/// All that a design adds: the device that evaluated it, design_json, trace_json of the figures' trace of
/// `scene`, and trace_warnings.
nlohmann::ordered_json finished_design_json(const std::string& device, const DesignTarget& target,
                                            const DesignFindings& result, const DesignForm& form,
                                            const DesignMetrics& figures, const Scene& scene,
                                            std::vector<std::string> of_project);

/// The table of target against result, losses, limits and tolerances for people, one line an entry.
std::vector<std::string> design_summary(const DesignTarget& target, const DesignFindings& result,
                                        const DesignForm& form, const DesignMetrics& figures);

}  // namespace lucerna
