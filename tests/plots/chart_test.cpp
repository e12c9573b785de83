// Charts as files: well-formed, inside their frame, nothing dropped.
#include "plots/charts/chart.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <expat.h>
#include <gtest/gtest.h>

#include "algorithms/scene/images/image.hpp"
#include "gl/error.hpp"
#include "plots/charts/svg_scene.hpp"
#include "plots/charts/text_font.hpp"
#include "tests/input_error.hpp"
#include "tests/temporary_folder.hpp"

namespace pellucid::plots {
namespace {

// The elements and all text that expat finds in a document.
struct Parsed {
  bool well_formed = false;
  int paths = 0;
  int clipped_and_moved = 0;  // one element with both: viewers then lose the plots
  std::string text;
};

Parsed parse(const std::string& svg) {
  Parsed parsed;
  XML_Parser parser = XML_ParserCreate("UTF-8");
  XML_SetUserData(parser, &parsed);
  XML_SetElementHandler(
      parser,
      [](void* user, const XML_Char* element, const XML_Char** attributes) {
        auto& out = *static_cast<Parsed*>(user);
        const std::string name = element;
        if (name == "polyline" || name == "path" || name == "polygon" || name == "line") ++out.paths;
        bool moved = false, clipped = false;
        for (; *attributes != nullptr; attributes += 2) {
          moved = moved || std::strcmp(attributes[0], "transform") == 0;
          clipped = clipped || std::strcmp(attributes[0], "clip-path") == 0;
        }
        if (moved && clipped) ++out.clipped_and_moved;
      },
      [](void*, const XML_Char*) {});
  XML_SetCharacterDataHandler(parser, [](void* user, const XML_Char* s, int n) {
    static_cast<Parsed*>(user)->text.append(s, static_cast<std::size_t>(n));
  });
  parsed.well_formed = XML_Parse(parser, svg.data(), static_cast<int>(svg.size()), 1) == XML_STATUS_OK;
  XML_ParserFree(parser);
  return parsed;
}

Chart sample() {
  Chart chart;
  chart.title = "A < B & \"C\"";
  chart.note = "a note";
  chart.x = {.label = "samples", .scale = Scale::log2};
  chart.y = {.label = "error", .scale = Scale::log10};
  chart.series.push_back({.label = "first", .points = {{1, 0.5, 0.4, 0.6}, {2, 0.1, 0.05, 0.2}, {64, 0.002}}});
  chart.series.push_back({.label = "second",
                          .points = {{1, 0.7}, {64, 0.01}},
                          .style = {.color = {213, 94, 0}, .marker = Marker::square}});
  return chart;
}

TEST(Chart, SvgIsWellFormedAndEscaped) {
  const Parsed parsed = parse(to_svg(sample()));
  EXPECT_TRUE(parsed.well_formed);
  EXPECT_EQ(parsed.clipped_and_moved, 0);
  Chart fewer = sample();
  fewer.series.pop_back();
  EXPECT_GT(parsed.paths, parse(to_svg(fewer)).paths) << "a second series draws more";
}

// VTK draws nothing, in no room, for a character that its font lacks: a text would lose it in silence.
TEST(Chart, EveryCharacterIsDrawnOrSpelledOut) {
  const TextStyle style{.size_px = 24};
  for (const std::string character : {"²", "⁻", "φ", "—", "日", "😀"})
    EXPECT_GT(text_width("n" + character + "n", style), text_width("nn", style) + 2) << character;
  // U+0378 is assigned to nothing, so that no font has it.
  EXPECT_EQ(drawn_text("a\u0378b", false).text, "aU+0378b");
  EXPECT_EQ(drawn_text("a\n\x1b b\xff\xed\xa0\x80", false).text, "a\\n\\x1b b\\xff\\xed\\xa0\\x80");
  Chart odd = sample();
  odd.title = odd.series[0].label = "a\x01\xfe";
  EXPECT_TRUE(parse(to_svg(odd)).well_formed);
  EXPECT_EQ(drawn_text("10\u207b\u00b3 µm", true).text, "10\u207b\u00b3 µm");
}

TEST(Chart, RefusesWhatCannotBeDrawn) {
  Chart empty = sample();
  empty.series.clear();
  test::input_error([&] { to_svg(empty); });
  Chart nan = sample();
  nan.series[1].points[1].y = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(test::input_error([&] { to_svg(nan); }).find("second"), std::string::npos)
      << "the message names the series";
  Chart negative = sample();
  negative.series[0].points[0].y = -1;
  EXPECT_NE(test::input_error([&] { to_svg(negative); }).find("first"), std::string::npos);
  EXPECT_NE(test::input_error([&] { write_chart(sample(), "chart.gif"); }).find(".svg"), std::string::npos);
}

TEST(Chart, TheLineReachesFromTheFirstPointToTheLastInsideThePlot) {
  Chart chart = sample();
  chart.series = {{.label = "",
                   .points = {{1, 0.5}, {8, 0.02}, {64, 0.1}},
                   .style = {.color = {213, 94, 0}, .marker = Marker::none}}};
  const test::TemporaryFolder folder;
  write_chart(chart, folder / "line.png");
  const Image image = read_image(folder / "line.png").image;
  const int zoom = image.width / chart.width_px;
  ASSERT_GE(zoom, 1);
  // Per column, the highest and the lowest pixel in the series' colour.
  std::vector<std::pair<int, int>> columns(static_cast<std::size_t>(image.width), {image.height, -1});
  int left = image.width, right = -1, top = image.height, bottom = -1;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const float* p = image.at(x, y);
      if (std::abs(p[0] - 213 / 255.0F) > 0.1F || std::abs(p[1] - 94 / 255.0F) > 0.1F || p[2] > 0.2F) continue;
      auto& [highest, lowest] = columns[static_cast<std::size_t>(x)];
      highest = std::min(highest, y);
      lowest = std::max(lowest, y);
      left = std::min(left, x);
      right = std::max(right, x);
      top = std::min(top, y);
      bottom = std::max(bottom, y);
    }
  }
  ASSERT_LT(left, right) << "no line at all";
  EXPECT_GT(left, 30 * zoom) << "right of the ordinate's labels";
  EXPECT_LT(right, image.width - 8 * zoom);
  EXPECT_GT(right - left, image.width / 2);
  EXPECT_GT(bottom - top, image.height / 3);
  EXPECT_LT(bottom, image.height - 50 * zoom) << "above the abscissa's labels";
  for (int x = left; x <= right; ++x)
    EXPECT_GE(columns[static_cast<std::size_t>(x)].second, 0) << "a gap at column " << x;
  // The first point is the highest, the second, half way on a logarithmic abscissa, the lowest.
  EXPECT_NEAR(columns[static_cast<std::size_t>(left + zoom)].first, top, 4 * zoom);
  EXPECT_NEAR(columns[static_cast<std::size_t>((left + right) / 2)].second, bottom, 4 * zoom);
}

TEST(Chart, MoreLegendNeedsMorePageNotLessPlot) {
  const auto height = [](const std::string& svg) {
    const std::string mark = "viewBox=\"0 0 460 ";
    return std::stoi(svg.substr(svg.find(mark) + mark.size()));
  };
  Chart chart = sample();
  EXPECT_EQ(height(to_svg(chart)), chart.height_px);
  for (int i = 0; i < 4; ++i) {
    chart.series.push_back(chart.series.back());
    chart.series.back().label = "a label that is so long that it needs a row of its own " + std::to_string(i);
  }
  EXPECT_EQ(height(to_svg(chart)), chart.height_px + 4 * 18);
}

TEST(Chart, AnUprightTitleLongerThanThePlotIsHighTakesTwoLines) {
  const test::TemporaryFolder folder;
  Chart chart = sample();
  const auto drawn = [&](const std::string& label) {
    chart.y.label = label;
    write_chart(chart, folder / "chart.png");
    return read_image(folder / "chart.png").image;
  };
  const Image brief = drawn("e"),
              wordy = drawn("mean error of the exit point in diagonals of the box that holds the whole object");
  ASSERT_EQ(brief.pixels.size(), wordy.pixels.size());
  const int zoom = brief.width / chart.width_px;
  const auto differ = [&](int from_y, int to_y) {
    int count = 0;
    for (int y = from_y * zoom; y < to_y * zoom; ++y)
      for (int x = 0; x < brief.width; ++x)
        count += brief.at(x, y)[0] != wordy.at(x, y)[0] ? 1 : 0;
    return count;
  };
  EXPECT_EQ(differ(0, 45), 0) << "it runs into the legend";
  EXPECT_EQ(differ(chart.height_px - 20, chart.height_px), 0) << "it runs into the note";
  EXPECT_GT(differ(45, chart.height_px - 20), 1000 * zoom) << "it is not there";
}

TEST(Chart, PicturesNeedTheConverter) {
  const test::TemporaryFolder folder;
  const std::string path = std::getenv("PATH");
  ::setenv("PATH", "/nowhere", 1);
  std::string words = "no error";
  try {
    write_chart(sample(), folder / "never.png");
  } catch (const RuntimeError& e) {
    words = e.what();
  }
  ::setenv("PATH", path.c_str(), 1);
  EXPECT_NE(words.find("rsvg-convert"), std::string::npos) << words;
  EXPECT_FALSE(std::filesystem::exists(folder / "never.png"));
}

TEST(Chart, FilesAreWhatTheirNameSays) {
  const test::TemporaryFolder folder;
  write_chart(sample(), folder / "c.svg");
  EXPECT_TRUE(parse(test::read_file(folder / "c.svg")).well_formed);
  write_chart(sample(), folder / "c.pdf");
  EXPECT_EQ(test::read_file(folder / "c.pdf").substr(0, 5), "%PDF-");
  write_chart(sample(), folder / "c.png");
  const Image image = read_image(folder / "c.png").image;
  EXPECT_NEAR(static_cast<double>(image.width) / image.height, 460.0 / 340.0, 0.01);
  // White paper, dark ink and both series' colours are on it.
  bool white = false, dark = false, orange = false;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const float* p = image.at(x, y);
      white = white || (p[0] > 0.99F && p[1] > 0.99F && p[2] > 0.99F);
      dark = dark || (p[0] < 0.2F && p[1] < 0.2F && p[2] < 0.2F);
      orange =
          orange || (std::abs(p[0] - 213 / 255.0F) < 0.02F && std::abs(p[1] - 94 / 255.0F) < 0.02F && p[2] < 0.02F);
    }
  }
  EXPECT_TRUE(white && dark && orange);
}

TEST(HeatMap, DrawsAndRefuses) {
  HeatMap map;
  map.title = "fps";
  map.columns = {"1", "2"};
  map.rows = {"1", "2", "4"};
  map.values = {{1.0, 2.0}, {3.0, std::nullopt}, {5.0, 6.0}};
  map.marks = {{{1, 0}, "theirs"}, {{0, 1}, "ours"}};
  const std::string svg = to_svg(map);
  EXPECT_TRUE(parse(svg).well_formed);
  // Words are drawn as outlines of letters; the description tells what is marked.
  EXPECT_NE(svg.find("Marked as theirs: (1, 2)."), std::string::npos);
  EXPECT_NE(svg.find("Marked as ours: (2, 1)."), std::string::npos);
  const auto paths = parse(svg).paths;
  map.marks[1].cell = {1, 0};
  EXPECT_TRUE(parse(to_svg(map)).well_formed) << "two marks in one cell";
  map.marks.clear();
  EXPECT_LT(parse(to_svg(map)).paths, paths);
  map.values[0][0] = std::numeric_limits<double>::infinity();
  test::input_error([&] { to_svg(map); });
}

}  // namespace
}  // namespace pellucid::plots
