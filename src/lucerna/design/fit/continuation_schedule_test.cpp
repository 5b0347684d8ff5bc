// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/fit/continuation_schedule.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <string>

#include "lucerna/error.h"

namespace lucerna {
namespace {

struct ScheduleCase {
  std::string name;
  ContinuationSchedule schedule;
  DesignShape shape;
};

std::vector<DesignShape> all_shapes() {
  std::vector<DesignShape> shapes;
  for (const int n : {1, 2, 3, 4, 5, 6, 7, 8, 10, 11, 16, 17, 24}) {
    shapes.push_back(DesignShape::revolution(15, Aperture::circle(100), n));
    shapes.push_back(DesignShape::trough(15, Aperture::rectangle(100, 60), n, false));
    shapes.push_back(DesignShape::bspline(15, Aperture::rectangle(100, 60), n, (n + 1) / 2));
    shapes.push_back(DesignShape::bspline(15, Aperture::circle(100), n, n));
  }
  return shapes;
}

/// Every family, many knots, few and many rays, with growth and without.
std::vector<ScheduleCase> make_schedules() {
  std::vector<ScheduleCase> cases;
  for (const DesignShape& shape : all_shapes()) {
    const TentBins bins =
        shape.is_revolution() ? TentBins::rings(Frame(), 0.5, 48) : TentBins::square(Frame(), 0.3, 48);
    for (const int rays : {13, 16, 22}) {
      for (const int knot_doublings : {0, 1, 2}) {
        cases.push_back({fmt::format("{} x {} intervals, 2^{} rays, growth {}", shape.intervals_x(),
                                     shape.intervals_y(), rays, knot_doublings),
                         continuation_schedule(shape, bins, {std::uint64_t{1} << rays, knot_doublings}),
                         shape});
      }
    }
  }
  return cases;
}

const std::vector<ScheduleCase>& all_schedules() {
  static const std::vector<ScheduleCase> kCases = make_schedules();
  return kCases;
}

TEST(ContinuationSchedule, RefinesOnlyAndNeverCoarsens) {
  for (const auto& [name, schedule, shape] : all_schedules()) {
    for (std::size_t i = schedule.search_stages() + 1; i < schedule.size(); ++i) {
      const FitStage &a = schedule[i - 1], &b = schedule[i];
      EXPECT_GE(b.intervals_x, a.intervals_x) << name << " at " << i;
      EXPECT_GE(b.intervals_y, a.intervals_y) << name << " at " << i;
      EXPECT_GE(b.bins, a.bins) << name << " at " << i;
      EXPECT_LE(b.widen, a.widen) << name << " at " << i;
      EXPECT_LE(b.smoothing, a.smoothing) << name << " at " << i;
      const bool more_knots = b.intervals_x > a.intervals_x || b.intervals_y > a.intervals_y;
      EXPECT_TRUE(more_knots || b.rays >= a.rays) << name << " at " << i;
      EXPECT_FALSE(b.search) << name << " at " << i;
    }
    for (std::size_t i = 1; i < schedule.search_stages(); ++i) {
      EXPECT_GT(schedule[i].cutoff, schedule[i - 1].cutoff) << name;  // from large scales to all of the light
      EXPECT_GE(schedule[i].rays, schedule[i - 1].rays) << name;
    }
  }
}

TEST(ContinuationSchedule, EndsWithTheShapesKnotsAndScreensOnce) {
  for (const auto& [name, schedule, shape] : all_schedules()) {
    EXPECT_EQ(schedule.last().intervals_x % shape.intervals_x(), 0) << name;
    EXPECT_GE(schedule.last().intervals_x, shape.intervals_x()) << name;
    EXPECT_EQ(schedule.last().smoothing, 0.0) << name;
    int screenings = 0;
    for (std::size_t i = 0; i < schedule.size(); ++i) screenings += schedule[i].screening ? 1 : 0;
    EXPECT_EQ(screenings, 1) << name;
    const ContinuationSchedule short_one = schedule.up_to_screening();
    EXPECT_EQ(short_one.size(), schedule.screening() + 1) << name;
    EXPECT_TRUE(short_one.last().screening) << name;
    EXPECT_TRUE(schedule.screens_from(schedule.screening())) << name;
    EXPECT_FALSE(schedule.screens_from(schedule.screening() + 1)) << name;
  }
}

TEST(ContinuationSchedule, EntriesAreBetweenTheSearchAndTheEnd) {
  for (const auto& [name, schedule, shape] : all_schedules()) {
    const std::size_t few = schedule.entry(InitialKnots::few_knots),
                      own = schedule.entry(InitialKnots::own_knots);
    EXPECT_EQ(few, schedule.search_stages()) << name;
    EXPECT_LE(few, own) << name;
    EXPECT_LE(own, schedule.screening()) << name;
    EXPECT_EQ(schedule.entry(InitialKnots::end), std::min(schedule.screening() + 1, schedule.size() - 1))
        << name;
  }
}

TEST(ContinuationSchedule, HasAStageThatIsNotTheSearchs) {
  FitStage search;
  search.search = true;
  EXPECT_THROW(ContinuationSchedule({search}), std::exception);
  EXPECT_THROW(ContinuationSchedule({}), std::exception);
}

}  // namespace
}  // namespace lucerna
