#include <algorithm>
#include <cstring>
#include <fstream>
#include <iostream>
#include <limits>
#include <map>
#include <mutex>
#include <sstream>

#include <fmt/format.h>
#include <vtkDataArray.h>
#include <vtkDataArraySelection.h>
#include <vtkDataObject.h>
#include <vtkImageData.h>
#include <vtkInformation.h>
#include <vtkLogger.h>
#include <vtkMetaImageReader.h>
#include <vtkNew.h>
#include <vtkObjectFactory.h>
#include <vtkPointData.h>
#include <vtkSmartPointer.h>
#include <vtkStreamingDemandDrivenPipeline.h>
#include <vtkStringOutputWindow.h>
#include <vtkXMLImageDataReader.h>

#include "algorithms/scene/volumes/volume_formats.hpp"

/// VTK XML image data and MetaImage through VTK's readers. All of VTK in the scene is in this file.
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

vtkInformation* active_scalars(vtkAlgorithm& reader) {
  return vtkDataObject::GetActiveFieldInformation(
      reader.GetOutputInformation(0), vtkDataObject::FIELD_ASSOCIATION_POINTS, vtkDataSetAttributes::SCALARS);
}

VolumeHeader header_of(vtkAlgorithm& reader) {
  VolumeHeader header;
  vtkInformation* information = reader.GetOutputInformation(0);
  int extent[6] = {0, -1, 0, -1, 0, -1};
  if (information->Has(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT()) != 0) {
    information->Get(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT(), extent);
  }
  for (int c = 0; c < 3; ++c) {
    const std::int64_t size = std::int64_t{extent[2 * c + 1]} - extent[2 * c] + 1;
    header.size[c] = static_cast<int>(std::clamp<std::int64_t>(size, 0, std::numeric_limits<int>::max()));
  }
  if (information->Has(vtkDataObject::SPACING()) != 0) information->Get(vtkDataObject::SPACING(), &header.spacing.x);
  vtkInformation* scalars = active_scalars(reader);
  if (scalars != nullptr && scalars->Has(vtkDataObject::FIELD_NUMBER_OF_COMPONENTS()) != 0) {
    header.components = scalars->Get(vtkDataObject::FIELD_NUMBER_OF_COMPONENTS());
  }
  return header;
}

/// The point data's scalars; without active ones, the only array.
vtkDataArray& scalars_of(const fs::path& path, vtkImageData& image) {
  vtkPointData* points = image.GetPointData();
  vtkDataArray* scalars = points->GetScalars();
  if (scalars == nullptr) scalars = points->GetArray(0);
  if (scalars == nullptr) fail_volume(path, "it has no numbers as point data");
  return *scalars;
}

/// `check_data`, called with what the header says, before anything is allocated.
template <class Reader, class CheckData>
VolumeFile load(const fs::path& path, std::uintmax_t bytes, CheckData&& check_data) {
  const KeptMessages messages;
  const auto check = [&] {
    if (const std::string error = messages.first_error(); !error.empty()) fail_volume(path, error);
  };
  vtkNew<Reader> reader;
  if (reader->CanReadFile(path.c_str()) == 0) {
    fail_volume(path, "it is malformed, or of another format than its name says");
  }
  reader->SetFileName(path.c_str());
  reader->UpdateInformation();
  check();
  const VolumeHeader header = header_of(*reader);
  check_header(path, header, bytes);
  check_data(*reader, header);

  reader->Update();
  check();
  vtkDataArray& scalars = scalars_of(path, *reader->GetOutput());
  if (scalars.GetNumberOfComponents() != 1) {
    fail_volume(path, fmt::format("{} values a voxel; one is needed", scalars.GetNumberOfComponents()));
  }
  if (static_cast<std::size_t>(scalars.GetNumberOfTuples()) != header.count()) {
    fail_volume(path,
                fmt::format("{} values where its header promises {}", scalars.GetNumberOfTuples(), header.count()));
  }
  VolumeFile volume{header.size, header.spacing, std::vector<float>(header.count()), {}};
  for (std::size_t i = 0; i < volume.values.size(); ++i)
    volume.values[i] = static_cast<float>(scalars.GetTuple1(static_cast<vtkIdType>(i)));
  return volume;
}

// ---- VTK XML image data ----

/// vtkXMLDataParser does not notice when it gets fewer bytes than it asked for. What it leaves alone is NaN then, and
/// an error to load_volume_file(); for integers it is at least always the same.
class MarkingReader : public vtkXMLImageDataReader {
 public:
  static MarkingReader* New();

 protected:
  int ReadArrayValues(vtkXMLDataElement* element, vtkIdType first, vtkAbstractArray* array, vtkIdType from,
                      vtkIdType count, FieldType type) override {
    constexpr int kAllBits = 0xFF;  // NaN as float and as double
    std::memset(array->GetVoidPointer(first), kAllBits,
                static_cast<std::size_t>(count) * static_cast<std::size_t>(array->GetDataTypeSize()));
    return vtkXMLImageDataReader::ReadArrayValues(element, first, array, from, count, type);
  }
};
vtkStandardNewMacro(MarkingReader);

/// The reader stops at appended data and would not miss what follows.
void check_end(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  const auto bytes = static_cast<std::streamoff>(fs::file_size(path));
  std::string tail(static_cast<std::size_t>(std::min<std::streamoff>(bytes, 64)), '\0');
  file.seekg(bytes - static_cast<std::streamoff>(tail.size()));
  file.read(tail.data(), static_cast<std::streamsize>(tail.size()));
  if (tail.find("</VTKFile>") == std::string::npos) fail_volume(path, "it does not end in '</VTKFile>'");
}

// ---- MetaImage ----

struct MetaText {
  std::map<std::string, std::string> values;
  std::uintmax_t bytes = 0;
};

/// "Key = value" up to ElementDataFile, which is the last.
MetaText read_meta_text(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  MetaText text;
  std::string line;
  for (int n = 0; n < 1000 && std::getline(file, line); ++n) {
    text.bytes += line.size() + (file.eof() ? 0 : 1);
    const auto equals = line.find('=');
    if (equals == std::string::npos) continue;
    const auto trimmed = [&](std::size_t begin, std::size_t end) {
      const auto first = line.find_first_not_of(" \t", begin);
      if (first == std::string::npos || first >= end) return std::string();
      return line.substr(first, line.find_last_not_of(" \t\r", end - 1) + 1 - first);
    };
    const std::string key = trimmed(0, equals);
    text.values[key] = trimmed(equals + 1, line.size());
    if (key == "ElementDataFile") return text;
  }
  fail_volume(path, "its header has no ElementDataFile");
}

bool is_true(const MetaText& text, const std::string& key) {
  const auto found = text.values.find(key);
  return found != text.values.end() && (found->second.starts_with('T') || found->second.starts_with('t'));
}

}  // namespace

VolumeFile load_vti(const fs::path& path) {
  check_end(path);
  // Only what is needed is read.
  const auto select = [&](vtkXMLImageDataReader& reader, const VolumeHeader&) {
    reader.GetCellDataArraySelection()->DisableAllArrays();
    vtkInformation* scalars = active_scalars(reader);
    const char* name = scalars != nullptr ? scalars->Get(vtkDataObject::FIELD_NAME()) : nullptr;
    vtkDataArraySelection* points = reader.GetPointDataArraySelection();
    if (name == nullptr && points->GetNumberOfArrays() != 1) {
      fail_volume(path, fmt::format("it has {} arrays of point data, none of them the active scalars; one is needed",
                                    points->GetNumberOfArrays()));
    }
    if (name == nullptr) return;
    points->DisableAllArrays();
    points->EnableArray(name);
  };
  return load<MarkingReader>(path, fs::file_size(path), select);
}

VolumeFile load_meta_image(const fs::path& path) {
  const MetaText text = read_meta_text(path);
  const std::string name = text.values.at("ElementDataFile");
  const bool local = name == "LOCAL" || name == "Local" || name == "local";
  if (name.starts_with("LIST") || name.find('%') != std::string::npos) {
    fail_volume(path, "its voxels lie in several files; one is read");
  }
  if (text.values.contains("BinaryData") && !is_true(text, "BinaryData"))
    fail_volume(path, "voxels as text are not read");
  const fs::path file = local ? path : path.parent_path() / name;
  std::error_code error;
  if (!fs::is_regular_file(file, error)) fail_volume(path, fmt::format("its data file '{}' is missing", file.string()));
  const std::uintmax_t offset = local ? text.bytes : 0;
  const std::uintmax_t bytes = fs::file_size(file) - offset;

  // The reader would fill up what is missing with zeros.
  const auto check_data = [&](vtkMetaImageReader& reader, const VolumeHeader& header) {
    const auto size = static_cast<std::uintmax_t>(vtkDataArray::GetDataTypeSize(reader.GetDataScalarType()));
    const std::uintmax_t promised = header.count() * size;
    std::uintmax_t found = bytes;
    if (is_true(text, "CompressedData")) {
      found = 0;
      unpack(path, read_behind(file, offset), [&](std::string_view piece) { found += piece.size(); });
    }
    const bool skips = text.values.contains("HeaderSize");
    if (found < promised || (found > promised && !skips)) {
      fail_volume(path, fmt::format("{} bytes of voxels where its header promises {}", found, promised));
    }
  };
  VolumeFile volume = load<vtkMetaImageReader>(path, bytes, check_data);
  if (!local) volume.files.push_back(file);
  return volume;
}

}  // namespace pellucid
