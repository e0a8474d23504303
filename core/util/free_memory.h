#pragma once

namespace plumbline {

// ReturnFreeMemoryOfLargeJob has jemalloc give free memory back to the system within a second
// from now on, if the job has grown so large that one stage's free memory would add to what
// the next one takes. Until then jemalloc keeps it (dirty_decay_ms:-1): to give it back and
// have it anew costs a small job 3 %. Programs with another allocator are left as they are.
void ReturnFreeMemoryOfLargeJob();

}  // namespace plumbline
