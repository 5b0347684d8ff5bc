// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lucerna/cli/parse/compress_arguments.h"
#include "lucerna/cli/parse/session.h"
#include "lucerna/source_model.h"

namespace lucerna::cli {

/// The end of `compress`: writes the model, prints its figures, judges it by rays held out, writes the report
/// unless its name is empty. With --strict an InputError for what was odd in the files, before all that.
void write_compress_output(const CompressArguments& arguments, const CompressedFiles& made, Session& session);

}  // namespace lucerna::cli
