#include "render/stored_frames.h"

#include <vtkDataArray.h>
#include <vtkLogger.h>
#include <vtkNew.h>
#include <vtkObjectFactory.h>
#include <vtkOutputWindow.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkSmartPointer.h>
#include <vtkXMLPolyDataReader.h>

#include <algorithm>
#include <filesystem>
#include <regex>
#include <sstream>

#include "output/frame_path.h"
#include "scene/fields.h"

namespace oilskin::demo {
namespace {

namespace fs = std::filesystem;

std::vector<Vec3> points_of(vtkPolyData* data) {
  std::vector<Vec3> x(static_cast<std::size_t>(data->GetNumberOfPoints()));
  for (std::size_t i = 0; i < x.size(); ++i) data->GetPoint(static_cast<vtkIdType>(i), x[i].data());
  return x;
}

/// An array of the points, or null.
vtkDataArray* array_of(vtkPolyData* data, const char* name, int components, const std::string& path) {
  vtkDataArray* const array = data->GetPointData()->GetArray(name);
  if (array == nullptr) return nullptr;
  if (array->GetNumberOfComponents() == components && array->GetNumberOfTuples() == data->GetNumberOfPoints())
    return array;
  throw SceneError(path + ": \"" + name + "\" has " + std::to_string(array->GetNumberOfTuples()) + " times " +
                   std::to_string(array->GetNumberOfComponents()) + " values, must have " +
                   std::to_string(data->GetNumberOfPoints()) + " times " + std::to_string(components));
}

/// VTK converts them to double, which is exact up to 2⁵³.
std::vector<std::uint64_t> ids_of(vtkPolyData* data, const std::string& path) {
  vtkDataArray* const stored = array_of(data, "id", 1, path);
  std::vector<std::uint64_t> ids(stored == nullptr ? 0 : std::size_t(data->GetNumberOfPoints()));
  for (std::size_t i = 0; i < ids.size(); ++i)
    ids[i] = static_cast<std::uint64_t>(stored->GetTuple1(static_cast<vtkIdType>(i)));
  return ids;
}

/// Percents would be wet all over. A vertex of a run may hold a little more than 1.
void check_wetness(const std::vector<float>& wetness, const std::string& path) {
  constexpr float most = 10;
  for (std::size_t v = 0; v < wetness.size(); ++v) {
    if (wetness[v] >= 0 && wetness[v] <= most) continue;
    std::ostringstream text;
    text << path << ": the wetness of vertex " << v << " is " << wetness[v]
         << ", must be 0 (dry) to 1 (all pores full)";
    throw SceneError(text.str());
  }
}

/// Messages of VTK while this lives are noted, not shown: the program writes its own.
class Listener : public vtkOutputWindow {
 public:
  static Listener* New() { VTK_STANDARD_NEW_BODY(Listener); }
  void DisplayText(const char*) override { heard_ = true; }
  bool heard() const { return heard_; }

 private:
  bool heard_ = false;
};

class Listening {
 public:
  Listening() {
    vtkOutputWindow::SetInstance(listener_);
    vtkLogger::SetStderrVerbosity(vtkLogger::VERBOSITY_OFF);
  }
  ~Listening() {
    vtkLogger::SetStderrVerbosity(vtkLogger::VERBOSITY_INFO);  // as it is at the start
    vtkOutputWindow::SetInstance(before_);
  }
  Listening(const Listening&) = delete;
  Listening& operator=(const Listening&) = delete;
  bool heard() const { return listener_->heard(); }

 private:
  vtkSmartPointer<vtkOutputWindow> before_ = vtkOutputWindow::GetInstance();
  vtkNew<Listener> listener_;
};

}  // namespace

StoredFrames::StoredFrames(const std::string& directory) : directory_(directory) {
  static const std::regex particles("particles_([0-9]{4,9})\\.vtp"),
      mesh("(cloth|body)_([0-9]{1,6})_([0-9]{4,9})\\.ply"), with_suffix(".*\\.(vtp|vtk|vtu|ply|PLY|VTP)");
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(directory, error)) {
    std::smatch match;
    const std::string file = entry.path().filename().string();
    // Of numbers written with other digits than ours, files could not be found again.
    const auto is_ours = [&](const std::string& name, int number, const char* suffix) {
      return frame_path(".", name, number, suffix) == "./" + file;
    };
    bool is_read = false;
    if (std::regex_match(file, match, particles)) {
      const int number = std::stoi(match[1]);
      is_read = is_ours("particles", number, "vtp");
      if (is_read) numbers_.push_back(number);
    } else if (std::regex_match(file, match, mesh)) {
      const int k = std::stoi(match[2]), number = std::stoi(match[3]);
      is_read = is_ours(std::string(match[1]) + "_" + std::to_string(k), number, "ply");
      if (is_read) (match[1] == "cloth" ? meshes_[number].cloth : meshes_[number].bodies).push_back(k);
    }
    if (!is_read && std::regex_match(file, with_suffix) && file.compare(0, 8, "surface_") != 0)
      other_files_.push_back(file);
  }
  if (error) throw SceneError(directory + ": " + error.message());
  std::sort(other_files_.begin(), other_files_.end());
  if (numbers_.empty())
    throw SceneError(directory +
                     ": there is no particles_NNNN.vtp, with four digits or more; `oilskin run` writes them" +
                     (other_files_.empty() ? "" : "; there is " + other_files_.front()));
  std::sort(numbers_.begin(), numbers_.end());
  for (auto& [number, meshes] : meshes_)
    for (std::vector<int>* kind : {&meshes.cloth, &meshes.bodies}) std::sort(kind->begin(), kind->end());
}

StoredFrame StoredFrames::read(int number) const {
  const std::string path = frame_path(directory_, "particles", number, "vtp");
  if (!fs::exists(path)) throw SceneError(path + ": is not there");
  const Listening listening;
  vtkNew<vtkXMLPolyDataReader> reader;
  reader->SetFileName(path.c_str());
  reader->Update();
  vtkPolyData* data = reader->GetOutput();
  if (listening.heard() || reader->GetErrorCode() != 0 || data == nullptr || data->GetPoints() == nullptr)
    throw SceneError(path + ": cannot be read as a VTK file of points; it is damaged or cut short");
  StoredFrame frame;
  frame.position = points_of(data);
  frame.id = ids_of(data, path);
  if (vtkDataArray* const velocity = array_of(data, "velocity", 3, path)) {
    frame.velocity.resize(frame.position.size());
    for (std::size_t i = 0; i < frame.velocity.size(); ++i)
      velocity->GetTuple(static_cast<vtkIdType>(i), frame.velocity[i].data());
  }
  if (vtkDataArray* const mass = array_of(data, "mass", 1, path))
    for (vtkIdType i = 0; i < mass->GetNumberOfTuples(); ++i) frame.mass.push_back(mass->GetTuple1(i));
  const auto found = meshes_.find(number);
  if (found == meshes_.end()) return frame;
  const auto add = [&](const std::string& kind, const std::vector<int>& all) {
    for (const int k : all) {
      const std::string mesh = frame_path(directory_, kind + "_" + std::to_string(k), number, "ply");
      frame.obstacles.push_back(read_ply(mesh));
      check_wetness(frame.obstacles.back().wetness, mesh);
    }
  };
  add("cloth", found->second.cloth);
  add("body", found->second.bodies);
  return frame;
}

}  // namespace oilskin::demo
