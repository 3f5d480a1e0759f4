#include "view/png_file.h"

#include <png.h>

#include "output/output_error.h"

namespace oilskin::demo {

void write_png(const std::string& path, int width, int height, const std::vector<unsigned char>& rgb) {
  png_image image = {};
  image.version = PNG_IMAGE_VERSION;
  image.width = static_cast<png_uint_32>(width);
  image.height = static_cast<png_uint_32>(height);
  image.format = PNG_FORMAT_RGB;
  if (png_image_write_to_file(&image, path.c_str(), 0, rgb.data(), 0, nullptr) == 0)
    throw OutputError(path + ": cannot be written: " + image.message);
}

}  // namespace oilskin::demo
