#include "render/frame_files.h"

#include <vtkDoubleArray.h>
#include <vtkNew.h>
#include <vtkPLYWriter.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkTypeInt64Array.h>
#include <vtkXMLPolyDataWriter.h>

#include <fstream>

#include "output/output_error.h"
#include "render/vtk_convert.h"

namespace oilskin::demo {
namespace {

void require_written(bool written, const std::string& path) {
  if (!written) throw OutputError(path + ": cannot be written; is the disk full?");
}

template <class Array>
void add_scalars(vtkPolyData* data, const char* name, Span<const double> values) {
  vtkNew<Array> array;
  array->SetName(name);
  array->SetNumberOfTuples(static_cast<vtkIdType>(values.size()));
  for (std::size_t i = 0; i < values.size(); ++i) array->SetValue(static_cast<vtkIdType>(i), values[i]);
  data->GetPointData()->AddArray(array);
}

}  // namespace

void write_particles(const std::string& path, const FrameData& frame) {
  vtkNew<vtkPolyData> data;
  data->SetPoints(to_vtk(frame.position, VTK_DOUBLE));
  data->SetVerts(vertex_cells(frame.position.size()));
  vtkNew<vtkTypeInt64Array> id;
  id->SetName("id");
  for (const std::uint64_t i : frame.id) id->InsertNextValue(static_cast<vtkTypeInt64>(i));
  vtkNew<vtkDoubleArray> velocity;
  velocity->SetName("velocity");
  velocity->SetNumberOfComponents(3);
  for (const Vec3& v : frame.velocity) velocity->InsertNextTuple(v.data());
  data->GetPointData()->AddArray(id);
  data->GetPointData()->AddArray(velocity);
  add_scalars<vtkDoubleArray>(data, "density", frame.density);
  add_scalars<vtkDoubleArray>(data, "pressure", frame.pressure);
  if (!frame.mass_ratio.empty()) {
    std::vector<double> mass;
    for (const float ratio : frame.mass_ratio)
      mass.push_back(static_cast<double>(ratio) * frame.particle_mass);
    add_scalars<vtkDoubleArray>(data, "mass", mass);
  }
  vtkNew<vtkXMLPolyDataWriter> writer;
  writer->SetFileName(path.c_str());
  writer->SetInputData(data);
  writer->SetDataModeToAppended();
  writer->EncodeAppendedDataOff();
  require_written(writer->Write() == 1 && writer->GetErrorCode() == 0, path);
}

void write_mesh(const std::string& path, const SurfaceMotion& motion) {
  vtkNew<vtkPolyData> data;
  data->SetPoints(to_vtk(motion.x_t1, VTK_FLOAT));
  data->SetPolys(to_vtk(motion.triangles));
  vtkNew<vtkPLYWriter> writer;
  writer->SetFileName(path.c_str());
  writer->SetFileTypeToBinary();
  writer->SetDataByteOrderToLittleEndian();
  writer->SetInputData(data);
  require_written(writer->Write() == 1 && writer->GetErrorCode() == 0, path);
}

void write_series(const std::string& directory, const std::vector<double>& times) {
  const std::string path = directory + "/run.pvd";
  std::ofstream out(path, std::ios::trunc);
  out.precision(17);
  out << "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\" "
         "byte_order=\"LittleEndian\">\n"
      << "  <Collection>\n";
  for (std::size_t i = 0; i < times.size(); ++i)
    out << "    <DataSet timestep=\"" << times[i] << "\" part=\"0\" file=\""
        << frame_path(".", "particles", static_cast<int>(i), "vtp").substr(2) << "\"/>\n";
  out << "  </Collection>\n</VTKFile>\n";
  require_written(static_cast<bool>(out.flush()), path);
}

}  // namespace oilskin::demo
