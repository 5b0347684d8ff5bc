// SPDX-License-Identifier: Apache-2.0
#include "lucerna/core/io/message_bytes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

namespace lucerna {
namespace {

TEST(MessageBytes, AreTakenInTheOrderTheyWereAppended) {
  const std::vector<float> floats{1.5F, -2.0F, 0.25F};
  const std::vector<std::uint32_t> none;
  std::string bytes;
  append(bytes, std::uint64_t{1} << 53);
  append(bytes, floats);
  append(bytes, none);
  append(bytes, std::uint64_t{7});
  EXPECT_EQ(bytes.size(), 8 + (8 + 12) + 8 + 8);

  std::string_view rest = bytes;
  std::vector<float> taken;
  std::vector<std::uint32_t> empty;
  EXPECT_EQ(take(rest), std::uint64_t{1} << 53);
  take(rest, taken);
  take(rest, empty);
  EXPECT_EQ(take(rest), 7);
  EXPECT_EQ(taken, floats);
  EXPECT_TRUE(empty.empty());
  EXPECT_TRUE(rest.empty());
}

TEST(MessageBytes, DoublesKeepTheirBits) {
  std::string bytes;
  for (const double x : {0.1, -0.0, 1e-310}) append_double(bytes, x);
  std::string_view rest = bytes;
  EXPECT_EQ(take_double(rest), 0.1);
  EXPECT_TRUE(std::signbit(take_double(rest)));
  EXPECT_EQ(take_double(rest), 1e-310);
}

TEST(MessageBytes, WhatEndsEarlyIsAnError) {
  std::string bytes;
  append(bytes, std::vector<double>{1.0, 2.0, 3.0});
  std::vector<double> items;
  for (const std::size_t n : {std::size_t{0}, std::size_t{7}, std::size_t{8}, bytes.size() - 1}) {
    std::string_view cut = std::string_view(bytes).substr(0, n);
    EXPECT_THROW(take(cut, items), std::logic_error) << n;
  }
}

}  // namespace
}  // namespace lucerna
