/// @file
/// The threads that the loops of the library run on: its own, or those of the host.
#pragma once

#include "oilskin/types.h"

namespace oilskin {

/// The tasks of one loop, numbered from 0. They are independent of each other.
class LoopTasks {
 public:
  /// Does the tasks begin … end − 1 of `loop`; throws nothing.
  using Function = void (*)(void* loop, int begin, int end);
  /// Is made by the library.
  LoopTasks(Function function, void* loop) : function_(function), loop_(loop) {}

  /// Does the tasks begin … end − 1 on the calling thread. Throws nothing.
  void operator()(int begin, int end) const { function_(loop_, begin, end); }

 private:
  Function function_;
  void* loop_;
};

/// The threads of a host. The results of the library do not depend on how many there are, nor on the order of
/// the tasks.
class JobSystem {
 public:
  virtual ~JobSystem() = default;

  /// How many tasks may run at once, ≥ 1. It is read before each loop; a loop is not given to a job system of
  /// one thread.
  virtual int threads() const = 0;

  /// Calls `tasks` for ranges that have each of 0 … count − 1 once, in any order and on any threads, and
  /// returns when all are done. count ≥ 2; tasks take up to some 0.1 ms. The calls happen after the start of
  /// run() and before its end in the sense of the memory model.
  ///
  /// It is called on the thread that called the library: on several at once where they call different worlds,
  /// and within a task of the host's where that calls the library. Tasks call no host and start no loop.
  ///
  /// What it throws, the call of the library throws (World: the step did not happen). None of the tasks may
  /// run then, nor later. Where tasks are left out or not in the range, the library throws
  /// std::runtime_error.
  virtual void run(int count, const LoopTasks& tasks) = 0;
};

/// The loops of worlds, contact solvers and reconstructions that are made from now on run on `jobs`, which
/// must outlive them; null: on the library's own threads (oneTBB), as at first. The settings `threads`: 1 =
/// on the caller's thread, as before; any other value leaves the number to `jobs`. Refuses a job system of
/// less than one thread. Thread-safe.
Status set_job_system(JobSystem* jobs);
/// What set_job_system() was given last; null = the library's own threads.
JobSystem* job_system();

}  // namespace oilskin
