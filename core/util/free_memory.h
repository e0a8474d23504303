#pragma once

namespace plumbline {

// Where the program's allocator is jemalloc and it keeps free memory (dirty_decay_ms:-1): from
// now on has it give that back to the system within a second, if a job has grown so large that
// one stage's free memory would add to what the next one takes. To give it back costs a tenth
// of a small job, in calls and in page faults.
void ReturnFreeMemoryOfLargeJob();

}  // namespace plumbline
