// SPDX-License-Identifier: Apache-2.0
#include "lucerna/core/io/file.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <filesystem>
#include <set>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "lucerna/core/io/error.h"
#include "tests/support/run_program.h"
#include "tests/support/temp_dir.h"

namespace lucerna {
namespace {

std::size_t entries(const std::filesystem::path& folder) {
  return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(folder), {}));
}

TEST(OutputFile, AppearsOnlyWhenCommitted) {
  const test::TempDir dir;
  {
    OutputFile file(dir / "a");
    file.write("half");
  }
  EXPECT_EQ(entries(dir.path()), 0u);
  write_file(dir / "a", "old");
  {
    OutputFile file(dir / "a");
    file.write("half");
  }
  EXPECT_EQ(read_file(dir / "a", 100), "old");
  write_file(dir / "a", "new");
  EXPECT_EQ(read_file(dir / "a", 100), "new");
  EXPECT_EQ(entries(dir.path()), 1u);
}

TEST(OutputFile, PatchesWhatWasWritten) {
  const test::TempDir dir;
  OutputFile file(dir / "a");
  file.write("count=? and more");
  file.patch(6, std::as_bytes(std::span("7", 1)));
  file.write("!");
  file.commit();
  EXPECT_EQ(read_file(dir / "a", 100), "count=7 and more!");
}

/// The cause of the InputError that `work` throws.
template <class Work>
ErrorCause cause_of(const Work& work) {
  try {
    work();
  } catch (const InputError& e) {
    return e.cause();
  }
  return ErrorCause::interrupted;
}

TEST(OutputFile, AnUnwritablePlaceIsOneClearLine) {
  const test::TempDir dir;
  EXPECT_EQ(cause_of([&] { OutputFile(dir / "missing" / "a"); }), ErrorCause::unwritable);
  EXPECT_EQ(cause_of([&] { OutputFile(dir.path()); }), ErrorCause::unwritable);
}

TEST(OutputFile, AFullDiskIsToldApart) {
  const test::TempDir dir;
  std::filesystem::create_symlink("/dev/full", dir / fmt::format("a.tmp{}-{}", ::getpid(), ::gettid()));
  EXPECT_EQ(cause_of([&] { write_file(dir / "a", "text"); }), ErrorCause::no_space);
  EXPECT_FALSE(std::filesystem::exists(dir / "a"));
}

/// Each file is one thread's, whole.
TEST(OutputFile, ThreadsMayWriteToOnePathAtOnce) {
  const test::TempDir dir;
  constexpr int kThreads = 4, kFiles = 50;
  std::atomic<int> failures{0};
  std::vector<std::thread> threads;
  for (int t = 0; t < kThreads; ++t) {
    threads.emplace_back([&, t] {
      for (int i = 0; i < kFiles; ++i) {
        try {
          write_file(dir / "a",
                     std::string(100'000 + 1000 * static_cast<std::size_t>(t), static_cast<char>('a' + t)));
          const std::string read = test::slurp(dir / "a");
          const std::size_t owner = static_cast<std::size_t>(read.at(0) - 'a');
          if (read != std::string(100'000 + 1000 * owner, read[0])) ++failures;
        } catch (const std::exception&) {
          ++failures;
        }
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(failures, 0);
}

TEST(ErrorCauses, HaveNamesOfTheirOwn) {
  std::set<std::string_view> names;
  for (const ErrorCause cause : kErrorCauses) EXPECT_TRUE(names.insert(to_string(cause)).second);
  EXPECT_FALSE(names.contains(""));
  EXPECT_EQ(static_cast<std::size_t>(ErrorCause::interrupted) + 1, kErrorCauses.size());
}

TEST(InputFile, NamesWhatIsMissing) {
  const test::TempDir dir;
  EXPECT_EQ(cause_of([&] { InputFile(dir / "none"); }), ErrorCause::not_found);
  EXPECT_EQ(cause_of([&] { InputFile(dir.path()); }), ErrorCause::unreadable);
  write_file(dir / "a", "12345");
  const InputFile file(dir / "a");
  std::array<std::byte, 4> four{};
  file.read_at(1, four);
  EXPECT_EQ(static_cast<char>(four[0]), '2');
  for (const std::uint64_t offset : {2ull, 5ull, 6ull, ~0ull})
    EXPECT_THROW(file.read_at(offset, four), InputError);
  EXPECT_THROW(read_file(dir / "a", 4), InputError);
}

TEST(Sha256, KnownAnswers) {
  const test::TempDir dir;
  write_file(dir / "a", "abc");  // FIPS 180-4 example
  EXPECT_EQ(sha256_of_file(dir / "a"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  write_file(dir / "b", "");
  EXPECT_EQ(sha256_of_file(dir / "b"), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
}

TEST(Check, PrintsConditionAndValues) {
  const int i = 5, n = 3;
  try {
    LUCERNA_CHECK(i < n, "i = {}, n = {}", i, n);
    FAIL();
  } catch (const std::logic_error& e) {
    EXPECT_NE(std::string(e.what()).find("i < n (i = 5, n = 3)"), std::string::npos) << e.what();
  }
}

// Whoever reads a path while others save to it gets one file or the other, never the size of one and the
// bytes of the other.
TEST(InputFile, HasTheSizeOfTheFileThatItOpened) {
  namespace fs = std::filesystem;
  const test::TempDir dir;
  const std::vector<std::string> contents{std::string(1000, 'a'), std::string(3000, 'b')};
  for (const std::string& text : contents) write_file(dir / text.substr(0, 1), text);
  const fs::path path = dir / "path", next = dir / "next";
  write_file(path, contents[0]);
  std::atomic<bool> done = false;
  std::thread saving([&] {
    for (std::size_t k = 0; !done; ++k) {
      fs::create_hard_link(dir / contents[k % 2].substr(0, 1), next);
      fs::rename(next, path);
      fs::remove(next);  // a rename to another name of the same file leaves both
    }
  });
  int mixed = 0;
  for (int k = 0; k < 20'000; ++k) {
    const InputFile file(path);
    std::string text(file.size(), '?');
    try {
      file.read_at(0, std::as_writable_bytes(std::span(text)));
    } catch (const InputError&) {
      text.clear();
    }
    mixed += std::find(contents.begin(), contents.end(), text) == contents.end();
  }
  done = true;
  saving.join();
  EXPECT_EQ(mixed, 0);
}

TEST(LowerEnding, IsThatOfTheNameAlone) {
  EXPECT_EQ(lower_ending("Folder.X/Lamp.v2.IES"), ".ies");
  EXPECT_EQ(lower_ending("folder.x/lamp"), "");
}

}  // namespace
}  // namespace lucerna
