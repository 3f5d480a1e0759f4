/// `oilskin run` as a process of its own, so that its peak memory is its own.
#pragma once

#include "scene/options.h"

namespace oilskin::demo {

/// A text that reads back as the same number.
std::string exact(double value);

/// The arguments of `oilskin` that mean `options`, without pictures.
std::vector<std::string> arguments_of(const RunOptions& options);

/// Runs this program with `arguments` and waits for it. Its exit code, or 128 + n when signal n ended it.
/// SIGINT and SIGTERM are passed on to it: see caught_signal(). Throws OutputError when no process can be
/// started.
int run_child(const std::vector<std::string>& arguments);

/// This program.
std::string program_path();

}  // namespace oilskin::demo
