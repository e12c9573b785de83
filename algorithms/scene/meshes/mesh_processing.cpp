#include "algorithms/scene/meshes/mesh_processing.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include <fmt/format.h>
#include <vtkCellArray.h>
#include <vtkCleanPolyData.h>
#include <vtkFeatureEdges.h>
#include <vtkFillHolesFilter.h>
#include <vtkFloatArray.h>
#include <vtkFlyingEdges3D.h>
#include <vtkImageConstantPad.h>
#include <vtkImageData.h>
#include <vtkImageInterpolator.h>
#include <vtkImageResize.h>
#include <vtkLoopSubdivisionFilter.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkPolyDataConnectivityFilter.h>
#include <vtkPolyDataNormals.h>
#include <vtkTriangleFilter.h>

#include "algorithms/scene/meshes/mesh_file.hpp"

namespace pellucid {
namespace {

using PolyData = vtkSmartPointer<vtkPolyData>;

PolyData to_vtk(const Mesh& mesh) {
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();  // welding compares for equality; no rounding in between
  for (const glm::vec3& p : mesh.positions)
    points->InsertNextPoint(static_cast<double>(p.x), static_cast<double>(p.y), static_cast<double>(p.z));
  vtkNew<vtkCellArray> triangles;
  for (const glm::uvec3& t : mesh.triangles) {
    const vtkIdType corners[] = {static_cast<vtkIdType>(t.x), static_cast<vtkIdType>(t.y), static_cast<vtkIdType>(t.z)};
    triangles->InsertNextCell(3, corners);
  }
  auto out = PolyData::New();
  out->SetPoints(points);
  out->SetPolys(triangles);
  return out;
}

void from_vtk(vtkPolyData& data, Mesh& mesh) {
  mesh.positions.clear();
  mesh.normals.clear();
  mesh.colors.clear();
  mesh.uvs.clear();
  mesh.triangles.clear();
  for (vtkIdType i = 0; i < data.GetNumberOfPoints(); ++i) {
    double p[3];
    data.GetPoint(i, p);
    mesh.positions.emplace_back(static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2]));
  }
  vtkNew<vtkIdList> corners;
  vtkCellArray* polygons = data.GetPolys();
  polygons->InitTraversal();
  while (polygons->GetNextCell(corners) != 0) {
    if (corners->GetNumberOfIds() != 3) continue;  // a triangle that the welding has closed up
    mesh.triangles.emplace_back(static_cast<unsigned>(corners->GetId(0)), static_cast<unsigned>(corners->GetId(1)),
                                static_cast<unsigned>(corners->GetId(2)));
  }
}

vtkIdType edges(vtkPolyData& data, bool boundary) {
  vtkNew<vtkFeatureEdges> found;
  found->SetInputData(&data);
  found->SetBoundaryEdges(boundary);
  found->SetNonManifoldEdges(!boundary);
  found->FeatureEdgesOff();
  found->ManifoldEdgesOff();
  found->Update();
  return found->GetOutput()->GetNumberOfCells();
}

PolyData welded(vtkPolyData& data) {
  vtkNew<vtkCleanPolyData> clean;
  clean->SetInputData(&data);
  clean->SetToleranceIsAbsolute(1);
  clean->SetAbsoluteTolerance(0.0);
  clean->Update();
  return clean->GetOutput();
}

// Every triangle counter-clockwise from outside.
PolyData outward(vtkPolyData& data) {
  vtkNew<vtkPolyDataNormals> normals;
  normals->SetInputData(&data);
  normals->ConsistencyOn();
  normals->AutoOrientNormalsOn();
  normals->SplittingOff();
  normals->ComputePointNormalsOff();
  normals->ComputeCellNormalsOn();
  normals->Update();
  return normals->GetOutput();
}

PolyData closed(vtkPolyData& data) {
  vtkNew<vtkFillHolesFilter> fill;
  fill->SetInputData(&data);
  fill->SetHoleSize(std::numeric_limits<double>::max());
  vtkNew<vtkTriangleFilter> triangles;
  triangles->SetInputConnection(fill->GetOutputPort());
  triangles->Update();
  const vtkIdType open = edges(*triangles->GetOutput(), true);
  if (open > 0) throw InputError(fmt::format("{} edges stay open after the holes were closed", open));
  return outward(*triangles->GetOutput());
}

PolyData subdivided(vtkPolyData& data, int times) {
  const auto triangles = static_cast<double>(data.GetNumberOfPolys()) * std::pow(4.0, times);
  if (triangles > static_cast<double>(kMaxTriangles)) {
    throw InputError(
        fmt::format("{} subdivisions make {:.0f} triangles; at most {} are taken", times, triangles, kMaxTriangles));
  }
  const vtkIdType forks = edges(data, false);
  if (forks > 0) throw InputError(fmt::format("{} edges have more than two triangles; Loop's rule needs two", forks));
  vtkNew<vtkLoopSubdivisionFilter> loop;
  loop->SetInputData(&data);
  loop->SetNumberOfSubdivisions(times);
  loop->Update();
  if (loop->GetOutput()->GetNumberOfPolys() == 0) throw InputError("the mesh cannot be subdivided by Loop's rule");
  return loop->GetOutput();
}

}  // namespace

void process_mesh(Mesh& mesh, const MeshProcessing& processing, double crease_deg) {
  if (!processing.any()) return;
  PolyData data = welded(*to_vtk(mesh));
  if (processing.close_holes) data = closed(*data);
  if (processing.subdivide > 0) data = subdivided(*data, processing.subdivide);
  from_vtk(*data, mesh);
  make_normals(mesh, crease_deg);
}

Mesh isosurface(const VolumeFile& volume, const IsosurfaceOptions& options) {
  const double min = volume.value_range.x, max = volume.value_range.y;
  if (!(options.level > min && options.level < max)) {
    throw InputError(fmt::format("level {} is not between the data's {} and {}", options.level, min, max));
  }
  const glm::ivec3& size = volume.size;
  vtkNew<vtkImageData> image;
  image->SetDimensions(size.x, size.y, size.z);
  image->SetSpacing(volume.spacing.x, volume.spacing.y, volume.spacing.z);
  // Values are taken from the level, so that a large offset costs no bits of the surface.
  image->AllocateScalars(VTK_FLOAT, 1);
  auto* values = static_cast<float*>(image->GetScalarPointer());
  const double farthest = std::max(max - options.level, options.level - min);
  const double scale = farthest > 1e30 || farthest < 1e-30 ? 1 / farthest : 1.0;
  for (std::size_t i = 0; i < volume.voxels.size(); ++i)
    values[i] = static_cast<float>((volume.voxels[i] - options.level) * scale);

  // Two voxels of the minimum all around close the surface; the cubic kernel reaches that far.
  vtkNew<vtkImageConstantPad> pad;
  pad->SetInputData(image);
  pad->SetConstant((min - options.level) * scale);
  pad->SetOutputWholeExtent(-2, size.x + 1, -2, size.y + 1, -2, size.z + 1);

  vtkNew<vtkFlyingEdges3D> contour;
  contour->ComputeNormalsOff();
  contour->ComputeGradientsOff();
  contour->ComputeScalarsOff();
  contour->SetValue(0, 0);
  if (options.refine > 1.0) {
    vtkNew<vtkImageInterpolator> cubic;
    cubic->SetInterpolationModeToCubic();
    vtkNew<vtkImageResize> resize;
    resize->SetInputConnection(pad->GetOutputPort());
    resize->SetInterpolator(cubic);
    resize->SetResizeMethodToMagnificationFactors();
    resize->SetMagnificationFactors(options.refine, options.refine, options.refine);
    contour->SetInputConnection(resize->GetOutputPort());
    contour->Update();
  } else {
    contour->SetInputConnection(pad->GetOutputPort());
    contour->Update();
  }
  if (contour->GetOutput()->GetNumberOfPolys() == 0) {
    throw InputError(fmt::format("the data nowhere pass level {}", options.level));
  }
  vtkNew<vtkPolyDataConnectivityFilter> largest;
  largest->SetInputData(welded(*contour->GetOutput()));
  largest->SetExtractionModeToLargestRegion();
  largest->Update();
  Mesh mesh;
  from_vtk(*welded(*outward(*largest->GetOutput())), mesh);
  make_normals(mesh, 180.0);
  return mesh;
}

}  // namespace pellucid
