#include "plots/charts/svg_scene.hpp"

#include <array>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <numbers>
#include <sstream>
#include <vector>

#include <fmt/format.h>
#include <vtkBrush.h>
#include <vtkChartXY.h>
#include <vtkContext2D.h>
#include <vtkContextActor.h>
#include <vtkContextItem.h>
#include <vtkContextScene.h>
#include <vtkGenericOpenGLRenderWindow.h>
#include <vtkNew.h>
#include <vtkObjectFactory.h>
#include <vtkPen.h>
#include <vtkRenderer.h>
#include <vtkSVGExporter.h>
#include <vtkSmartPointer.h>
#include <vtkTextProperty.h>
#include <vtkXMLDataElement.h>
#include <vtkXMLUtilities.h>

#include "algorithms/scene/files/tell.hpp"
#include "gl/error.hpp"
#include "plots/charts/scratch_file.hpp"
#include "plots/charts/text_font.hpp"

namespace pellucid::plots {
namespace {

/// Begins the context with the device that the exporter forces on it; the factory's own override asks for OpenGL.
class DeviceActor : public vtkContextActor {
 public:
  static DeviceActor* New();
  vtkTypeMacro(DeviceActor, vtkContextActor)

      protected : void Initialize(vtkViewport* viewport) override {
    if (this->ForceDevice == nullptr) return;
    this->Context->Begin(this->ForceDevice);
    this->Initialized = true;
    static_cast<void>(viewport);
  }
};
vtkStandardNewMacro(DeviceActor);

class PaintItem : public vtkContextItem {
 public:
  static PaintItem* New();
  vtkTypeMacro(PaintItem, vtkContextItem) std::function<void(Painter&)> paint;
  bool Paint(vtkContext2D* context) override {
    Painter painter(context);
    if (paint) paint(painter);
    return true;
  }
};
vtkStandardNewMacro(PaintItem);

/// Sets the property up, and returns the text as it is to be drawn with it.
std::string apply(const TextStyle& style, const std::string& text, vtkTextProperty* property) {
  const DrawnText drawn = drawn_text(text, style.bold);
  property->SetFontFamilyToArial();
  if (!drawn.font_file.empty()) {
    property->SetFontFamily(VTK_FONT_FILE);
    property->SetFontFile(drawn.font_file.c_str());
  }
  property->SetFontSize(static_cast<int>(std::lround(style.size_px)));
  property->SetBold(style.bold ? 1 : 0);
  property->SetColor(style.color.r / 255.0, style.color.g / 255.0, style.color.b / 255.0);
  property->SetOrientation(style.upright ? 90 : 0);
  const auto set = [](Align align, auto low, auto centre, auto high) {
    if (align == Align::low)
      low();
    else if (align == Align::centre)
      centre();
    else
      high();
  };
  set(
      style.horizontal, [&] { property->SetJustificationToLeft(); }, [&] { property->SetJustificationToCentered(); },
      [&] { property->SetJustificationToRight(); });
  set(
      style.vertical, [&] { property->SetVerticalJustificationToBottom(); },
      [&] { property->SetVerticalJustificationToCentered(); }, [&] { property->SetVerticalJustificationToTop(); });
  return drawn.text;
}

bool is_invisible(vtkXMLDataElement* element) {
  const auto has = [&](const char* name, const char* value) {
    const char* found = element->GetAttribute(name);
    return found != nullptr && std::string(found) == value;
  };
  // VTK's way to say "no pen" is a dash of length nought; "no brush" is a fill that lets everything through.
  return has("stroke-dasharray", "0,10") || (has("fill-opacity", "0") && element->GetAttribute("stroke") == nullptr);
}

void repair_element(vtkXMLDataElement* element, int height_px) {
  if (std::string(element->GetName()) == "clipPath") {
    for (int i = 0; i < element->GetNumberOfNestedElements(); ++i) {
      vtkXMLDataElement* rect = element->GetNestedElement(i);
      double y = 0, h = 0;
      if (rect->GetScalarAttribute("y", y) != 0 && rect->GetScalarAttribute("height", h) != 0) {
        rect->SetAttribute("y", fmt::format("{}", height_px - y - h).c_str());
      }
    }
    return;
  }
  const char* clip = element->GetAttribute("clip-path");
  const char* transform = element->GetAttribute("transform");
  if (clip != nullptr && transform != nullptr) {
    vtkNew<vtkXMLDataElement> inner;
    inner->SetName("g");
    inner->SetAttribute("transform", transform);
    for (int i = 0; i < element->GetNumberOfNestedElements(); ++i)
      inner->AddNestedElement(element->GetNestedElement(i));
    element->RemoveAllNestedElements();
    element->RemoveAttribute("transform");
    element->AddNestedElement(inner);
  }
  for (int i = element->GetNumberOfNestedElements() - 1; i >= 0; --i) {
    vtkXMLDataElement* child = element->GetNestedElement(i);
    if (is_invisible(child))
      element->RemoveNestedElement(child);
    else
      repair_element(child, height_px);
  }
}

}  // namespace

double text_width(const std::string& text, const TextStyle& style) {
  vtkNew<vtkTextProperty> property;
  const std::string drawn = apply(style, text, property);
  property->SetOrientation(0);
  return drawn_width(property, drawn);
}

std::vector<std::string> wrap_text(const std::string& text, const TextStyle& style, double width) {
  std::vector<std::string> lines;
  std::istringstream words(text);
  for (std::string word; words >> word;) {
    if (!lines.empty() && text_width(lines.back() + " " + word, style) <= width)
      lines.back() += " " + word;
    else
      lines.push_back(word);
  }
  return lines;
}

void Painter::text(double x, double y, const std::string& string, const TextStyle& style) {
  const std::string drawn = apply(style, string, context_->GetTextProp());
  context_->DrawString(static_cast<float>(x), static_cast<float>(y), drawn);
}

void Painter::line(double x0, double y0, double x1, double y1, const Color& color, double width, Line type) {
  if (type == Line::none) return;
  vtkPen* pen = context_->GetPen();
  pen->SetColor(color.r, color.g, color.b, 255);
  pen->SetWidth(static_cast<float>(width));
  pen->SetLineType(type == Line::solid    ? vtkPen::SOLID_LINE
                   : type == Line::dashed ? vtkPen::DASH_LINE
                                          : vtkPen::DOT_LINE);
  context_->DrawLine(static_cast<float>(x0), static_cast<float>(y0), static_cast<float>(x1), static_cast<float>(y1));
}

void Painter::marker(double x, double y, double size, const Marker& marker, const Color& color, bool white_rim) {
  if (marker == Marker::none) return;
  const double r = size / 2;
  if (marker == Marker::cross || marker == Marker::plus) {
    const double arm = marker == Marker::cross ? r * 0.85 : r * 1.1;
    const double slope = marker == Marker::cross ? arm : 0;
    line(x - arm, y - slope, x + arm, y + slope, color, 1.6);
    line(x - slope, y + arm, x + slope, y - arm, color, 1.6);
    return;
  }
  // Regular polygons of about the same area; (corners, turn of the first corner, radius).
  int corners = 24;
  double turn = 0, radius = r * 0.95;
  if (marker == Marker::square) corners = 4, turn = 0.25, radius = r * 1.2;
  if (marker == Marker::diamond) corners = 4, turn = 0, radius = r * 1.25;
  if (marker == Marker::triangle_up) corners = 3, turn = 0.5, radius = r * 1.3;
  if (marker == Marker::triangle_down) corners = 3, turn = -0.5, radius = r * 1.3;
  std::vector<float> outline;
  for (int i = 0; i < corners; ++i) {
    const double angle = std::numbers::pi * (turn + 2.0 * i / corners);
    outline.push_back(static_cast<float>(x + radius * std::cos(angle)));
    outline.push_back(static_cast<float>(y + radius * std::sin(angle)));
  }
  vtkPen* pen = context_->GetPen();
  const Color rim = white_rim ? Color{255, 255, 255} : color;
  pen->SetColor(rim.r, rim.g, rim.b, 255);
  pen->SetWidth(0.8F);
  pen->SetLineType(vtkPen::SOLID_LINE);
  context_->GetBrush()->SetColor(color.r, color.g, color.b, 255);
  context_->DrawPolygon(outline.data(), corners);
  outline.push_back(outline[0]);
  outline.push_back(outline[1]);
  context_->DrawPoly(outline.data(), corners + 1);
}

void Painter::rectangle(double x, double y, double width, double height, const Color& fill) {
  context_->GetPen()->SetLineType(vtkPen::NO_PEN);
  context_->GetBrush()->SetColor(fill.r, fill.g, fill.b, 255);
  context_->DrawRect(static_cast<float>(x), static_cast<float>(y), static_cast<float>(width),
                     static_cast<float>(height));
}

void repair_svg(vtkXMLDataElement* root, int width_px, int height_px) {
  repair_element(root, height_px);
  root->SetAttribute("viewBox", fmt::format("0 0 {} {}", width_px, height_px).c_str());
  vtkNew<vtkXMLDataElement> ground;
  ground->SetName("rect");
  ground->SetAttribute("width", fmt::format("{}", width_px).c_str());
  ground->SetAttribute("height", fmt::format("{}", height_px).c_str());
  ground->SetAttribute("fill", "#ffffff");
  // Behind the drawing, which is the page's only group.
  std::vector<vtkSmartPointer<vtkXMLDataElement>> drawn;
  for (int i = 0; i < root->GetNumberOfNestedElements(); ++i) {
    if (std::string(root->GetNestedElement(i)->GetName()) == "g") drawn.emplace_back(root->GetNestedElement(i));
  }
  for (const auto& group : drawn)
    root->RemoveNestedElement(group);
  root->AddNestedElement(ground);
  for (const auto& group : drawn)
    root->AddNestedElement(group);
}

std::string draw_svg(const SvgScene& scene) {
  vtkNew<vtkGenericOpenGLRenderWindow> window;
  window->SetSize(scene.width_px, scene.height_px);
  vtkNew<vtkRenderer> renderer;
  window->AddRenderer(renderer);
  vtkNew<DeviceActor> actor;
  renderer->AddActor(actor);
  if (scene.chart != nullptr) actor->GetScene()->AddItem(scene.chart);
  vtkNew<PaintItem> item;
  item->paint = scene.paint;
  actor->GetScene()->AddItem(item);
  actor->GetScene()->SetRenderer(renderer);

  const ScratchFile file;
  vtkNew<vtkSVGExporter> exporter;
  exporter->SetRenderWindow(window);
  exporter->SetTitle(printable(scene.title).c_str());  // XML has no control characters
  exporter->SetDescription(printable(scene.description).c_str());
  exporter->SetFileName(file.path().c_str());
  exporter->Write();  // the plots find their places in the first pass and are drawn in the second
  exporter->Write();

  std::ifstream stream(file.path(), std::ios::binary);
  std::stringstream text;
  text << stream.rdbuf();
  const auto root =
      vtkSmartPointer<vtkXMLDataElement>::Take(vtkXMLUtilities::ReadElementFromString(text.str().c_str()));
  if (root == nullptr)
    throw RuntimeError("the chart '" + scene.title + "' could not be drawn: VTK wrote no readable SVG");
  repair_svg(root, scene.width_px, scene.height_px);
  std::ostringstream out;
  out << "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n";
  root->PrintXML(out, vtkIndent());
  return out.str();
}

}  // namespace pellucid::plots
