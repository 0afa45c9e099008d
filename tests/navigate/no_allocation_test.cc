#include <atomic>
#include <cstdlib>
#include <new>

#include "testing/flown_path.h"
#include <gtest/gtest.h>

#include "pilotage/geo/position_covariance.h"
#include "pilotage/navigate/navigation_filter.h"

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)  // they bring their own malloc

namespace {

std::atomic<long> g_allocations{0};

}  // namespace

// Eigen allocates with malloc, the standard library with operator new; glibc lets a program put its own in front.
extern "C" void* __libc_malloc(std::size_t size);
extern "C" void* malloc(std::size_t size) {
  g_allocations.fetch_add(1, std::memory_order_relaxed);
  return __libc_malloc(size);
}

namespace pilotage {
namespace {

TEST(NavigationFilter, AllocatesNothingInItsLoop) {
  InsOptions options;
  options.grade = InsGrade::kIndustrial;
  options.velocity_aid_sigma_mps = 1;
  FlownPath path({16.5, 55.5}, 25, 20, {{5, 8, 90}});
  NavigationFilter filter(make_ins_error_model(options), {}, path.state());
  const long before = g_allocations.load();
  int taken = 0;
  for (int i = 1; i <= 2000; ++i) {
    ASSERT_TRUE(filter.advance(path.fly(0.01)));
    if (i % 20 == 0) filter.take_height(path.kHeight_m);
    if (i % 50 == 0) filter.take_velocity(Eigen::Vector2d(filter.estimate().velocity_enu_mps.head<2>()), 0.5);
    if (i % 100 == 0) {
      const FrameNumber frame = filter.take_frame();
      PositionMeasurement measured{filter.match_prior(frame, 120)->position, 9 * Eigen::Matrix2d::Identity()};
      if (i % 500 == 0) measured.position.lat_deg += 1;  // one that is refused
      taken += filter.take_fix(frame, measured).outcome == FixOutcome::kTaken ? 1 : 0;
    }
  }
  EXPECT_EQ(g_allocations.load(), before);
  EXPECT_EQ(taken, 16);
  void* const counted = std::malloc(32);
  EXPECT_GT(g_allocations.load(), before) << "the test counts";
  std::free(counted);
}

}  // namespace
}  // namespace pilotage

#endif
