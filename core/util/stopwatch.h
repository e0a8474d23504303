#pragma once

#include <chrono>

namespace plumbline {

// Adds up wall-clock time over any number of stretches.
class Stopwatch {
 public:
  using Clock = std::chrono::steady_clock;

  // Runs the watch while it lives.
  class Running {
   public:
    explicit Running(Stopwatch* watch) : watch_(watch), start_(Clock::now()) {}
    ~Running() { watch_->total_ += Clock::now() - start_; }
    Running(const Running&) = delete;
    Running& operator=(const Running&) = delete;

   private:
    Stopwatch* watch_;
    Clock::time_point start_;
  };

  double seconds() const { return std::chrono::duration<double>(total_).count(); }

 private:
  Clock::duration total_ = Clock::duration::zero();
};

}  // namespace plumbline
