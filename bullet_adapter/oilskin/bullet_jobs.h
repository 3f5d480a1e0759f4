/// @file
/// The loops of the library on Bullet's threads.
#pragma once

#include <LinearMath/btThreads.h>

#include "oilskin/job_system.h"

namespace oilskin::bullet {

/// Gives the loops of the library to a task scheduler of Bullet; for set_job_system().
///
/// A Bullet that was built without BT_THREADSAFE, as Debian's, has no scheduler but the sequential one: the
/// loops then run on the caller's thread. One's own btITaskScheduler works with every Bullet.
class btFluidJobSystem : public JobSystem {
 public:
  /// The scheduler is the caller's. Null: the one that btGetTaskScheduler() returns at each loop.
  explicit btFluidJobSystem(btITaskScheduler* scheduler = nullptr) : m_scheduler(scheduler) {}

  /// btITaskScheduler::getNumThreads(); 1 without a scheduler.
  int threads() const override;
  /// btITaskScheduler::parallelFor() with at least eight ranges for each thread, where there are as many
  /// tasks.
  void run(int count, const LoopTasks& tasks) override;

 private:
  btITaskScheduler* m_scheduler;
};

}  // namespace oilskin::bullet
