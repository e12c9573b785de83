#include <algorithm>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <limits>
#include <memory>
#include <mutex>
#include <sstream>
#include <streambuf>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <vtkCellData.h>
#include <vtkDataArray.h>
#include <vtkDataArraySelection.h>
#include <vtkDataObject.h>
#include <vtkImageData.h>
#include <vtkInformation.h>
#include <vtkLogger.h>
#include <vtkNew.h>
#include <vtkObjectFactory.h>
#include <vtkPointData.h>
#include <vtkSmartPointer.h>
#include <vtkStreamingDemandDrivenPipeline.h>
#include <vtkStringOutputWindow.h>
#include <vtkXMLImageDataReader.h>

#include "algorithms/scene/volumes/volume_formats.hpp"

/// VTK XML image data through VTK's reader.
namespace pellucid {

namespace fs = std::filesystem;

namespace {

/// While it lives, what VTK and its libraries would print is kept: the readers report errors in no other way. One at a
/// time, because what they print to is one for all.
class KeptMessages {
 public:
  KeptMessages()
      : lock_(mutex()),
        window_before_(vtkOutputWindow::GetInstance()),
        verbosity_before_(vtkLogger::GetCurrentVerbosityCutoff()),
        errors_before_(std::cerr.rdbuf(errors_.rdbuf())) {
    vtkOutputWindow::SetInstance(window_);
    vtkLogger::SetStderrVerbosity(vtkLogger::VERBOSITY_OFF);
  }
  ~KeptMessages() {
    std::cerr.rdbuf(errors_before_);
    vtkLogger::SetStderrVerbosity(verbosity_before_);
    vtkOutputWindow::SetInstance(window_before_);
  }
  KeptMessages(const KeptMessages&) = delete;
  KeptMessages& operator=(const KeptMessages&) = delete;

  /// The first error; empty if there was none.
  std::string first_error() const {
    const std::string all = window_->GetOutput();
    const auto error = all.find("ERROR");
    if (error == std::string::npos) return first_line(errors_.str());
    // "ERROR: In FILE, line N" is followed by "vtkClass (address): text".
    const auto line = all.find('\n', error);
    if (line == std::string::npos) return all.substr(error);
    const std::string text = first_line(all.substr(line + 1));
    const auto end_of_class = text.find("): ");
    return end_of_class == std::string::npos ? text : text.substr(end_of_class + 3);
  }

 private:
  static std::string first_line(const std::string& text) { return text.substr(0, text.find('\n')); }
  static std::mutex& mutex() {
    static std::mutex one;
    return one;
  }
  std::lock_guard<std::mutex> lock_;
  vtkSmartPointer<vtkOutputWindow> window_before_;
  vtkNew<vtkStringOutputWindow> window_;
  vtkLogger::Verbosity verbosity_before_;
  std::ostringstream errors_;
  std::streambuf* errors_before_;
};

/// The arrays of point data are the voxels, or where there are none those of cell data, one voxel in each cell.
struct Arrays {
  bool in_cells = false;
  std::string name;  ///< of the active scalars, or the only array
};

std::string names_of(vtkDataArraySelection& arrays) {
  std::vector<std::string> names;
  for (int i = 0; i < arrays.GetNumberOfArrays(); ++i)
    names.push_back(fmt::format("'{}'", arrays.GetArrayName(i)));
  return fmt::format("{}", fmt::join(names, ", "));
}

Arrays choose(const fs::path& path, vtkXMLImageDataReader& reader) {
  vtkDataArraySelection* points = reader.GetPointDataArraySelection();
  vtkDataArraySelection* cells = reader.GetCellDataArraySelection();
  Arrays chosen;
  chosen.in_cells = points->GetNumberOfArrays() == 0 && cells->GetNumberOfArrays() > 0;
  vtkDataArraySelection& arrays = chosen.in_cells ? *cells : *points;
  const std::string_view kind = chosen.in_cells ? "cell data" : "point data";
  if (arrays.GetNumberOfArrays() == 0) fail_volume(path, "it has neither point data nor cell data");
  vtkInformation* active = vtkDataObject::GetActiveFieldInformation(
      reader.GetOutputInformation(0),
      chosen.in_cells ? vtkDataObject::FIELD_ASSOCIATION_CELLS : vtkDataObject::FIELD_ASSOCIATION_POINTS,
      vtkDataSetAttributes::SCALARS);
  const char* name = active != nullptr ? active->Get(vtkDataObject::FIELD_NAME()) : nullptr;
  if (name == nullptr && arrays.GetNumberOfArrays() != 1) {
    fail_volume(path, fmt::format("it has {} arrays of {}, {}, and none of them is the active scalars; one is needed",
                                  arrays.GetNumberOfArrays(), kind, names_of(arrays)));
  }
  chosen.name = name != nullptr ? name : arrays.GetArrayName(0);
  if (arrays.ArrayExists(chosen.name.c_str()) == 0)
    fail_volume(path,
                fmt::format("its active scalars '{}' are none of its {}, {}", chosen.name, kind, names_of(arrays)));
  points->DisableAllArrays();
  cells->DisableAllArrays();
  arrays.EnableArray(chosen.name.c_str());
  return chosen;
}

VolumeHeader header_of(vtkAlgorithm& reader, bool in_cells) {
  VolumeHeader header;
  vtkInformation* information = reader.GetOutputInformation(0);
  int extent[6] = {0, -1, 0, -1, 0, -1};
  if (information->Has(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT()) != 0) {
    information->Get(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT(), extent);
  }
  for (int c = 0; c < 3; ++c) {
    std::int64_t size = std::int64_t{extent[2 * c + 1]} - extent[2 * c] + 1;
    if (in_cells && size > 1) --size;  // an axis of one point has cells that are flat
    header.size[c] = static_cast<int>(std::clamp<std::int64_t>(size, 0, std::numeric_limits<int>::max()));
  }
  if (information->Has(vtkDataObject::SPACING()) != 0) information->Get(vtkDataObject::SPACING(), &header.spacing.x);
  return header;
}

/// How VTK holds the array's numbers; no bytes when it does so in no way of ours.
VoxelType type_of(vtkDataArray& array) {
  const int type = array.GetDataType();
  const int bits = 8 * array.GetDataTypeSize();
  if (type == VTK_FLOAT || type == VTK_DOUBLE) return voxel_type(VoxelKind::floating, bits);
  if (type == VTK_BIT) return {};
  const bool has_sign = array.GetDataTypeMin() < 0;
  return voxel_type(has_sign ? VoxelKind::signed_integer : VoxelKind::unsigned_integer, bits);
}

/// vtkXMLDataParser does not notice when it gets fewer bytes than it asked for. The rest is NaN then, and
/// an error to load_volume_file(); for integers it is at least always the same.
class MarkingReader : public vtkXMLImageDataReader {
 public:
  static MarkingReader* New();

 protected:
  int ReadArrayValues(vtkXMLDataElement* element, vtkIdType first, vtkAbstractArray* array, vtkIdType from,
                      vtkIdType count, FieldType type) override {
    constexpr int kAllBits = 0xFF;  // NaN as float and as double
    if (is_of_texts(array)) return 1;
    if (count > 0)
      std::memset(array->GetVoidPointer(first), kAllBits,
                  static_cast<std::size_t>(count) * static_cast<std::size_t>(array->GetDataTypeSize()));
    return vtkXMLImageDataReader::ReadArrayValues(element, first, array, from, count, type);
  }
  int ReadArrayForPoints(vtkXMLDataElement* element, vtkAbstractArray* array) override {
    return is_of_texts(array) ? 1 : vtkXMLImageDataReader::ReadArrayForPoints(element, array);
  }
  int ReadArrayForCells(vtkXMLDataElement* element, vtkAbstractArray* array) override {
    return is_of_texts(array) ? 1 : vtkXMLImageDataReader::ReadArrayForCells(element, array);
  }

 private:
  /// An array of texts is refused by load_vti(); VTK 9.1 writes beyond its end where the file has more than it
  /// promises, and reads beyond it where a piece is larger than the whole.
  static bool is_of_texts(vtkAbstractArray* array) { return vtkDataArray::SafeDownCast(array) == nullptr; }
};
vtkStandardNewMacro(MarkingReader);

/// The reader stops at appended data and would not miss what follows.
void check_end(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  const auto bytes = static_cast<std::streamoff>(fs::file_size(path));
  std::string tail(static_cast<std::size_t>(std::min<std::streamoff>(bytes, 1 << 16)), '\0');
  file.seekg(bytes - static_cast<std::streamoff>(tail.size()));
  file.read(tail.data(), static_cast<std::streamsize>(tail.size()));
  tail.resize(tail.find_last_not_of(" \t\r\n") + 1);
  if (!tail.ends_with("</VTKFile>")) fail_volume(path, "it does not end in '</VTKFile>'");
}

}  // namespace

VolumeFile load_vti(const fs::path& path) {
  check_end(path);
  const KeptMessages messages;
  const auto check = [&] {
    if (const std::string error = messages.first_error(); !error.empty()) fail_volume(path, error);
  };
  vtkNew<MarkingReader> reader;
  if (reader->CanReadFile(path.c_str()) == 0) {
    fail_volume(path, "it is malformed, or of another format than its name says");
  }
  reader->SetFileName(path.c_str());
  reader->UpdateInformation();
  check();
  const Arrays chosen = choose(path, *reader);
  const VolumeHeader header = header_of(*reader, chosen.in_cells);
  check_header(path, header, fs::file_size(path));

  reader->Update();
  check();
  vtkImageData* image = reader->GetOutput();
  vtkDataSetAttributes* attributes = image->GetPointData();
  if (chosen.in_cells) attributes = image->GetCellData();
  vtkSmartPointer<vtkDataArray> array = attributes->GetArray(chosen.name.c_str());
  if (array == nullptr) fail_volume(path, fmt::format("its array '{}' has no numbers", chosen.name));
  if (array->GetNumberOfComponents() != 1) {
    fail_volume(path, fmt::format("{} values a voxel; one is needed", array->GetNumberOfComponents()));
  }
  if (static_cast<std::size_t>(array->GetNumberOfTuples()) != header.count()) {
    fail_volume(path,
                fmt::format("{} values where its header promises {}", array->GetNumberOfTuples(), header.count()));
  }
  const VoxelType type = type_of(*array);
  if (type.bytes == 0) fail_volume(path, fmt::format("voxels of type {} are not read", array->GetDataTypeAsString()));
  VolumeFile volume;
  volume.size = header.size;
  volume.spacing = header.spacing;
  const auto* bytes = static_cast<const char*>(array->GetVoidPointer(0));
  volume.voxels =
      StoredVoxels(std::make_shared<vtkSmartPointer<vtkDataArray>>(array), bytes, header.count(), type, false);
  return volume;
}

}  // namespace pellucid
