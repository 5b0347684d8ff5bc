// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <filesystem>

#include "tests/support/paths.h"

/// First line of every test labelled `data`: names the file, and skips visibly where the folder is missing.
/// `file` is relative to LUCERNA_DATA_DIR ("rayfiles/farfield.TM25ray").
#define LUCERNA_DATA_FILE(variable, file)                                    \
  const std::filesystem::path variable = lucerna::test::data_dir() / (file); \
  if (!std::filesystem::exists(variable)) GTEST_SKIP() << "no " << (variable) << " (set LUCERNA_DATA_DIR)"
