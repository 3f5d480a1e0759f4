/// Pictures as PNG files.
#pragma once

#include <string>
#include <vector>

namespace oilskin::demo {

/// `rgb`: three bytes per pixel, rows from above. Throws OutputError where the file cannot be written.
void write_png(const std::string& path, int width, int height, const std::vector<unsigned char>& rgb);

}  // namespace oilskin::demo
