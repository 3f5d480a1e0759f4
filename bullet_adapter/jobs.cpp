#include "oilskin/bullet_jobs.h"

#include <algorithm>

namespace oilskin::bullet {

namespace {

struct LoopBody : btIParallelForBody {
  const LoopTasks& tasks;
  explicit LoopBody(const LoopTasks& t) : tasks(t) {}
  void forLoop(int begin, int end) const override { tasks(begin, end); }
};

}  // namespace

int btFluidJobSystem::threads() const {
  const btITaskScheduler* scheduler = m_scheduler ? m_scheduler : btGetTaskScheduler();
  return scheduler ? std::max(1, scheduler->getNumThreads()) : 1;
}

void btFluidJobSystem::run(int count, const LoopTasks& tasks) {
  btITaskScheduler* scheduler = m_scheduler ? m_scheduler : btGetTaskScheduler();
  if (scheduler)
    scheduler->parallelFor(0, count, std::max(1, count / (8 * threads())), LoopBody(tasks));
  else
    tasks(0, count);
}

}  // namespace oilskin::bullet
