/// The motion trace of a run, or of a range of its steps, to a file or to standard output.
#pragma once

#include <fstream>
#include <memory>

#include "oilskin/trace.h"
#include "scene/options.h"

namespace oilskin::demo {

class TraceOutput : public IntervalObserver {
 public:
  /// Throws SceneError when the file cannot be written.
  TraceOutput(const std::string& file, const StepRange& steps);

  /// The step that comes, counted from 0.
  void begin_step(std::uint64_t step) { step_ = step; }
  void on_interval(const Interval& interval) override;
  /// No interval was written.
  bool is_empty() const { return is_empty_; }
  /// Throws OutputError when something could not be written.
  void check();

 private:
  std::string name_;
  std::ofstream file_;
  std::unique_ptr<TraceWriter> writer_;
  std::ostream* stream_ = nullptr;
  StepRange steps_;
  std::uint64_t step_ = 0;
  bool is_empty_ = true;
};

}  // namespace oilskin::demo
