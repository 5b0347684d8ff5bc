// SPDX-License-Identifier: Apache-2.0
#include "lucerna/trace/toml_reader.h"

#include <gtest/gtest.h>

#include <functional>

#include "lucerna/core/error.h"
#include "lucerna/core/file.h"
#include "tests/support/temp_dir.h"

namespace lucerna {
namespace {

/// The message that reading `text` with `read` gives, or "" if it reads.
std::string reader_message(const std::string& text, const std::function<void(TomlReader&)>& read) {
  const test::TempDir dir;
  write_file(dir / "p.toml", text);
  try {
    const toml::table table = parse_toml_file(dir / "p.toml");
    TomlReader reader(table, (dir / "p.toml").string(), "");
    read(reader);
    reader.finish();
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
                             EXPECT_EQ(r.number("n"), 3.0);
                             EXPECT_EQ(r.number("x", 0.0), 1.5);
                             EXPECT_EQ(r.number("absent", 7.0), 7.0);
                             EXPECT_EQ(r.text("name"), "led");
                             EXPECT_EQ(r.flag("on"), true);
                             EXPECT_EQ(r.vector("v"), (Vec3{1, 2, 3}));
                             EXPECT_EQ(r.number_or_numbers("v")->size(), 3u);
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
  const std::string text = reader_message("a = 1\nfocal_mn = 3\n", [](TomlReader& r) {
    r.number("a");
    r.number("focal_mm");
    r.number("diameter_mm");
  });
  EXPECT_TRUE(has(text, "line 2: focal_mn: unknown key; the nearest known one is 'focal_mm'")) << text;
}

TEST(TomlReader, WrongTypesAndValuesAreNamed) {
  const auto number = [](TomlReader& r) { r.number("a"); };
  EXPECT_TRUE(has(reader_message("a = 'x'", number), "line 1: a: found a string, expected a number"));
  EXPECT_TRUE(has(reader_message("a = true", number), "found a boolean"));
  EXPECT_TRUE(has(reader_message("a = nan", number), "expected a finite number"));
  EXPECT_TRUE(
      has(reader_message("a = -1", [](TomlReader& r) { r.positive("a"); }), "found -1, expected > 0"));
  EXPECT_TRUE(
      has(reader_message("a = [1, 2]", [](TomlReader& r) { r.vector("a"); }), "found 2 numbers, expected 3"));
  EXPECT_TRUE(has(reader_message("a = [0, 0, 0]", [](TomlReader& r) { r.axis("a"); }), "zero vector"));
  EXPECT_TRUE(has(reader_message("a = 'up'", [](TomlReader& r) { r.axis("a"); }), "found 'up', expected +x"));
  EXPECT_TRUE(
      has(reader_message("a = [[1, 2], [3]]", [](TomlReader& r) { r.pairs("a"); }), "item 2 has 1 numbers"));
  EXPECT_TRUE(has(reader_message("a = 1", [](TomlReader& r) { r.table("a"); }), "expected a table [a]"));
  EXPECT_TRUE(has(reader_message("a = 1", [](TomlReader& r) { r.tables("a"); }), "expected tables [[a]]"));
  EXPECT_TRUE(has(reader_message("", [](TomlReader& r) { r.required_text("a"); }), "a: is missing"));
}

TEST(TomlReader, SyntaxErrorsHaveLineAndColumn) {
  EXPECT_TRUE(has(reader_message("a = 1\nb = = 2\n", [](TomlReader&) {}), "line 2, column 5"));
}

}  // namespace
}  // namespace lucerna
