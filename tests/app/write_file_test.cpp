// Files that are written at once: whole, or refused without a trace.
#include "output/write_file.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "app/program.h"
#include "output/output_error.h"

namespace oilskin::test {
namespace {

std::size_t entries_of(const Folder& folder) {
  std::size_t count = 0;
  for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator(folder.path())) ++count;
  return count;
}

TEST(WriteFile, replaces_what_was_there_byte_for_byte) {
  const Folder folder;
  const std::string bytes("a\0b\r\n\xff", 6);
  for (const std::string& content : {std::string(100000, 'x'), bytes, std::string()}) {
    demo::write_file(folder.path("file"), content);
    EXPECT_EQ(folder.read("file"), content);
    EXPECT_EQ(entries_of(folder), 1u) << "the temporary file is gone";
  }
}

TEST(WriteFile, a_folder_that_is_not_there_is_refused_by_name_and_reason) {
  const Folder folder;
  const std::string path = folder.path("none/file");
  try {
    demo::write_file(path, "text");
    ADD_FAILURE() << "written";
  } catch (const demo::OutputError& e) {
    EXPECT_EQ(std::string(e.what()), path + ": cannot be written: No such file or directory");
  }
  EXPECT_EQ(entries_of(folder), 0u);
}

TEST(WriteFile, a_name_that_cannot_be_replaced_leaves_no_temporary_file) {
  const Folder folder;
  std::filesystem::create_directories(folder.path("file/within"));
  EXPECT_THROW(demo::write_file(folder.path("file"), "text"), demo::OutputError);
  EXPECT_EQ(entries_of(folder), 1u);
  EXPECT_TRUE(std::filesystem::is_directory(folder.path("file/within")));
}

}  // namespace
}  // namespace oilskin::test
