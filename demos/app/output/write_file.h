/// Files that are whole, or not there.
#pragma once

#include <string>

namespace oilskin::demo {

/// Written beside its place and renamed, so that a file of that name is whole. Throws OutputError; an earlier
/// file of that name then remains.
void write_file(const std::string& path, const std::string& content);

}  // namespace oilskin::demo
