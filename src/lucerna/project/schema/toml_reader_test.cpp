// SPDX-License-Identifier: Apache-2.0
#include "lucerna/project/schema/toml_reader.h"

#include <gtest/gtest.h>

#include <functional>

#include "lucerna/core/io/error.h"
#include "lucerna/core/io/file.h"
#include "tests/support/temp_dir.h"

namespace lucerna {
namespace {

using Type = KeyType;

const std::vector<ProjectKey> kTestKeys{
    {"", "n", Type::number_or_numbers, {}, "", "", ""},
    {"", "x", Type::number, {}, "", "", ""},
    {"", "absent", Type::number, {}, "", "", ""},
    {"", "name", Type::text, {}, "", "", ""},
    {"", "on", Type::flag, {}, "", "", ""},
    {"", "v", Type::vector, {}, "", "", ""},
    {"", "axis", Type::axis, {}, "", "", ""},
    {"", "slant", Type::axis, {}, "", "", ""},
    {"", "profile", Type::pairs, {}, "", "", ""},
    {"", "file", Type::file, {}, "", "", ""},
    {"", "part", Type::table, {}, "", "", ""},
    {"part", "k", Type::number, {}, "", "", ""},
    {"", "many", Type::tables, {}, "", "", ""},
    {"many", "i", Type::number, {}, "", "", ""},
    {"", "focal_mm", Type::number, {.min = 0.0, .min_excluded = true}, "", "", ""},
    {"", "diameter_mm", Type::number, {}, "", "", ""},
    {"", "count", Type::numbers, {.min = 1.0, .max = 60.0, .whole = true}, "", "", ""},
    {"", "bins", Type::word, {}, "hard tent soft", "", ""},
};

void read_test_file(const std::string& text, const std::function<void(TomlReader&)>& read) {
  const test::TempDir dir;
  write_file(dir / "p.toml", text);
  const toml::table table = parse_toml_file(dir / "p.toml");
  TomlReader reader(table, (dir / "p.toml").string(), "", kTestKeys);
  read(reader);
  reader.finish();
}

/// The message that reading `text` with `read` gives, or "" if it reads.
std::string reader_message(const std::string& text, const std::function<void(TomlReader&)>& read) {
  try {
    read_test_file(text, read);
  } catch (const InputError& e) {
    return e.what();
  }
  return "";
}

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

TEST(TomlReader, ReadsWhatIsThere) {
  const std::string text =
      "n = 3\nx = 1.5\nname = 'led'\non = true\nv = [1, 2, 3]\naxis = '-y'\nslant = [0, 3, 4]\n"
      "profile = [[0, 0], [1, 0.5]]\nfile = 'a.nfl'\n[part]\nk = 1\n[[many]]\ni = 0\n[[many]]\ni = 1\n";
  EXPECT_EQ(reader_message(text,
                           [](TomlReader& r) {
                             EXPECT_EQ(r.number("x", 0.0), 1.5);
                             EXPECT_EQ(r.number("absent", 7.0), 7.0);
                             EXPECT_EQ(r.text("name"), "led");
                             EXPECT_EQ(r.flag("on"), true);
                             EXPECT_EQ(r.vector("v"), (Vec3{1, 2, 3}));
                             EXPECT_EQ(r.number_or_numbers("n"), std::vector{3.0});
                             EXPECT_EQ(r.axis("axis")->vec(), (Vec3{0, -1, 0}));
                             EXPECT_NEAR(r.axis("slant")->z(), 0.8, 1e-15);
                             EXPECT_EQ(r.pairs("profile")->at(1)[1], 0.5);
                             EXPECT_EQ(r.file("file")->filename(), "a.nfl");
                             EXPECT_TRUE(r.file("file")->is_absolute());
                             auto part = r.table("part");
                             EXPECT_EQ(part->number("k"), 1.0);
                             part->finish();
                             auto many = r.tables("many");
                             ASSERT_EQ(many.size(), 2u);
                             EXPECT_EQ(many[1].number("i"), 1.0);
                             EXPECT_EQ(many[1].path(), "many[1]");
                           }),
            "");
}

TEST(TomlReader, AnUnknownKeyNamesTheNearestKnownOne) {
  const std::string text = reader_message("x = 1\nfocal_mn = 3\n", [](TomlReader& r) {
    r.number("x");
    r.number("focal_mm");
    r.number("diameter_mm");
  });
  EXPECT_TRUE(has(text, "line 2: focal_mn: unknown key; the nearest known one is 'focal_mm'")) << text;
}

TEST(TomlReader, AKeyInTheWrongPlaceIsNotCalledMisspelt) {
  const auto read = [](TomlReader& r) { r.number("focal_mm"); };
  EXPECT_TRUE(has(reader_message("focal_mm = 1\nname = 'a'\n", read),
                  "line 2: name: has a meaning only with other keys"))
      << reader_message("name = 'a'\n", read);
  EXPECT_TRUE(
      has(reader_message("k = 1\n", read), "line 1: k: unknown key here; [part] has one of this name"))
      << reader_message("k = 1\n", read);
}

// A wrong unit is two letters or more away from the right one, and another key may be nearer.
TEST(TomlReader, AKeyWithAnotherUnitIsNamed) {
  for (const char* key : {"focal_in", "focal_inch", "focal"}) {
    const std::string text = std::string("x = 1\n") + key + " = 3\n";
    const std::string expected =
        std::string("line 2: ") + key + ": unknown key; the nearest known one is 'focal_mm'";
    const std::string optional = reader_message(text, [](TomlReader& r) {
      r.number("x");
      r.number("focal_mm");
      r.flag("on");
    });
    EXPECT_TRUE(has(optional, expected)) << optional;
    const std::string required = reader_message(text, [](TomlReader& r) {
      r.number("x");
      if (!r.number("focal_mm")) r.missing("focal_mm");
    });
    EXPECT_TRUE(has(required, expected + ", which is missing")) << required;
  }
  // A key of the same kind of table that was only not asked for yet is none.
  EXPECT_TRUE(has(reader_message("x = 1\n", [](TomlReader& r) { r.missing("n"); }), "n: is missing"));
}

TEST(TomlReader, WrongTypesAndValuesAreNamed) {
  const auto number = [](TomlReader& r) { r.number("x"); };
  const auto focal = [](TomlReader& r) { r.number("focal_mm"); };
  const auto count = [](TomlReader& r) { r.numbers("count"); };
  const auto vector = [](TomlReader& r) { r.vector("v"); };
  const auto axis = [](TomlReader& r) { r.axis("axis"); };
  const auto bins = [](TomlReader& r) { r.required_word("bins"); };
  EXPECT_TRUE(has(reader_message("x = 'x'", number), "line 1: x: found a string, expected a number"));
  EXPECT_TRUE(has(reader_message("x = true", number), "found a boolean"));
  EXPECT_TRUE(has(reader_message("x = nan", number), "expected a finite number"));
  EXPECT_TRUE(has(reader_message("focal_mm = -1", focal), "found -1, expected > 0"));
  EXPECT_TRUE(
      has(reader_message("count = [1, 2.5]", count), "found 2.5, expected a whole number from 1 to 60"));
  EXPECT_TRUE(has(reader_message("v = [1, 2]", vector), "found 2 numbers, expected 3"));
  EXPECT_TRUE(has(reader_message("axis = [0, 0, 0]", axis), "zero vector"));
  EXPECT_TRUE(has(reader_message("axis = 'up'", axis), "found 'up', expected +x"));
  EXPECT_TRUE(has(reader_message("profile = [[1, 2], [3]]", [](TomlReader& r) { r.pairs("profile"); }),
                  "item 2 has 1 numbers"));
  EXPECT_TRUE(
      has(reader_message("part = 1", [](TomlReader& r) { r.table("part"); }), "expected a table [part]"));
  EXPECT_TRUE(
      has(reader_message("many = 1", [](TomlReader& r) { r.tables("many"); }), "expected tables [[many]]"));
  EXPECT_TRUE(has(reader_message("", bins), "bins: is missing"));
  for (const char* wrong : {"bins = 'har'", "bins = ''", "bins = 'hard tent'"})
    EXPECT_TRUE(has(reader_message(wrong, bins), "expected hard, tent or soft")) << wrong;
}

TEST(TomlReader, ErrorsSayWhatKindTheyAre) {
  const auto cause = [](const std::string& text) {
    try {
      read_test_file(text, [](TomlReader& r) {
        r.number("focal_mm");
        r.required_word("bins");
      });
    } catch (const InputError& e) {
      return e.cause();
    }
    return ErrorCause::interrupted;
  };
  EXPECT_EQ(cause("bins = 'hard'\nfocal_mm = -1\n"), ErrorCause::out_of_range);
  EXPECT_EQ(cause("focal_mm = 1\n"), ErrorCause::missing);
  EXPECT_EQ(cause("bins = 'hard'\nfocal = 1\n"), ErrorCause::unknown_key);
  EXPECT_EQ(cause("bins = 3\n"), ErrorCause::invalid);
}

TEST(TomlReader, ReadsNoKeyThatTheSchemaDoesNotHave) {
  EXPECT_THROW(reader_message("", [](TomlReader& r) { r.number("unheard_of"); }), std::logic_error);
  EXPECT_THROW(reader_message("", [](TomlReader& r) { r.number("name"); }), std::logic_error) << "a text";
  EXPECT_THROW(reader_message("[part]\n", [](TomlReader& r) { r.table("part")->number("x"); }),
               std::logic_error);
}

TEST(TomlReader, SyntaxErrorsHaveLineAndColumn) {
  EXPECT_TRUE(has(reader_message("x = 1\nb = = 2\n", [](TomlReader&) {}), "line 2, column 5"));
}

}  // namespace
}  // namespace lucerna
