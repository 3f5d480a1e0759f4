#include "stored_frames.h"

#include <vtkDataArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkXMLPolyDataReader.h>

#include <algorithm>
#include <filesystem>
#include <regex>

#include "fields.h"
#include "frame_path.h"

namespace oilskin::demo {
namespace {

namespace fs = std::filesystem;

std::vector<Vec3> points_of(vtkPolyData* data) {
  std::vector<Vec3> x(static_cast<std::size_t>(data->GetNumberOfPoints()));
  for (std::size_t i = 0; i < x.size(); ++i) data->GetPoint(static_cast<vtkIdType>(i), x[i].data());
  return x;
}

/// Files of the frame that match, in the order of their number K.
std::vector<std::string> meshes_of(const std::string& directory, const char* kind, int number) {
  std::vector<std::string> found;
  for (int k = 0;; ++k) {
    const std::string path =
        frame_path(directory, std::string(kind) + "_" + std::to_string(k), number, "ply");
    if (fs::exists(path))
      found.push_back(path);
    else if (k > 999)  // surfaces that were left out leave holes in the numbers
      return found;
  }
}

}  // namespace

std::vector<int> stored_frames(const std::string& directory) {
  static const std::regex name("particles_([0-9]{4,9})\\.vtp");
  std::vector<int> numbers;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(directory, error)) {
    std::smatch match;
    const std::string file = entry.path().filename().string();
    if (!std::regex_match(file, match, name)) continue;
    const int number = std::stoi(match[1]);
    if (frame_path(".", "particles", number, "vtp") == "./" + file) numbers.push_back(number);
  }
  if (error) throw SceneError(directory + ": " + error.message());
  if (numbers.empty())
    throw SceneError(directory + ": there is no particles_NNNN.vtp; `oilskin run` writes them");
  std::sort(numbers.begin(), numbers.end());
  return numbers;
}

StoredFrame read_frame(const std::string& directory, int number) {
  const std::string path = frame_path(directory, "particles", number, "vtp");
  if (!fs::exists(path)) throw SceneError(path + ": is not there");
  vtkNew<vtkXMLPolyDataReader> reader;
  reader->SetFileName(path.c_str());
  reader->Update();
  vtkPolyData* data = reader->GetOutput();
  if (reader->GetErrorCode() != 0 || data == nullptr || data->GetPoints() == nullptr)
    throw SceneError(path + ": cannot be read as a VTK file of points");
  StoredFrame frame;
  frame.position = points_of(data);
  vtkDataArray* velocity = data->GetPointData()->GetArray("velocity");
  if (velocity != nullptr && velocity->GetNumberOfComponents() == 3) {
    frame.velocity.resize(frame.position.size());
    for (std::size_t i = 0; i < frame.velocity.size(); ++i)
      velocity->GetTuple(static_cast<vtkIdType>(i), frame.velocity[i].data());
  }
  for (const char* kind : {"cloth", "body"})
    for (const std::string& file : meshes_of(directory, kind, number))
      frame.obstacles.push_back(read_ply(file));
  return frame;
}

}  // namespace oilskin::demo
