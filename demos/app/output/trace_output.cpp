#include "output/trace_output.h"

#include <iostream>

#include "output/output_error.h"
#include "scene/fields.h"

namespace oilskin::demo {

TraceOutput::TraceOutput(const std::string& file, const StepRange& steps) : name_(file), steps_(steps) {
  if (file == "-") {
    name_ = "standard output";
    stream_ = &std::cout;
  } else {
    file_.open(file, std::ios::binary | std::ios::trunc);
    if (!file_) throw SceneError("--trace " + file + ": cannot be written");
    stream_ = &file_;
  }
  writer_ = std::make_unique<TraceWriter>(*stream_);
}

void TraceOutput::on_interval(const Interval& interval) {
  if (step_ < steps_.first || step_ > steps_.last) return;
  writer_->on_interval(interval);
  is_empty_ = false;
}

void TraceOutput::check() {
  if (!stream_->flush()) throw OutputError(name_ + ": the trace cannot be written on; is the disk full?");
}

}  // namespace oilskin::demo
