// SPDX-License-Identifier: Apache-2.0
#include "lucerna/cli/commands/run.h"

int main(int argc, char** argv) { return lucerna::cli::run(argc, argv); }
