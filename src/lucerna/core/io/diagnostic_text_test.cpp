// SPDX-License-Identifier: Apache-2.0
#include "lucerna/core/io/diagnostic_text.h"

#include <gtest/gtest.h>

namespace lucerna {
namespace {

TEST(Diagnostic, TakesThePlaceFromTheFrontOfAMessage) {
  EXPECT_EQ(diagnostic(Severity::warning, "ray 17 (byte 9): no direction"),
            (Diagnostic{Severity::warning, "ray 17 (byte 9)", "no direction"}));
  EXPECT_EQ(diagnostic(Severity::error, "byte 20: cut"), (Diagnostic{Severity::error, "byte 20", "cut"}));
  EXPECT_EQ(diagnostic(Severity::note, "found: nothing"), (Diagnostic{Severity::note, "", "found: nothing"}));
  EXPECT_EQ(diagnostic(Severity::note, "rays"), (Diagnostic{Severity::note, "", "rays"}));
}

TEST(Diagnostic, LeavesOutTheNameOfTheFile) {
  EXPECT_EQ(diagnostic(InputError("a/b.ies: line 7: no number"), "a/b.ies"),
            (Diagnostic{Severity::error, "line 7", "no number"}));
  EXPECT_EQ(diagnostic(InputError("elsewhere: no"), "a/b.ies"),
            (Diagnostic{Severity::error, "", "elsewhere: no"}));
}

TEST(Diagnostic, IsPrintedWithItsPlace) {
  EXPECT_EQ(to_string(Diagnostic{Severity::error, line_place(3), "what"}), "line 3: what");
  EXPECT_EQ(to_string(Diagnostic{Severity::error, line_place(0), "what"}), "what");
  EXPECT_EQ(line_of({Severity::note, line_place(41), ""}), 41u);
  EXPECT_EQ(line_of({Severity::note, "byte 41", ""}), 0u);
  EXPECT_EQ(to_string(Severity::note), "note");
}

}  // namespace
}  // namespace lucerna
