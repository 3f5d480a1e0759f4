/// A loop on the threads of a host.
#pragma once

#include <cstddef>

#include "oilskin/job_system.h"

namespace oilskin {

/// Calls task(context, i) for i in 0 … count − 1 on the job system. Throws what a task throws: that of the
/// first task where several do.
void run_on_host(JobSystem& jobs, std::size_t count, void (*task)(const void*, std::size_t),
                 const void* context);

}  // namespace oilskin
