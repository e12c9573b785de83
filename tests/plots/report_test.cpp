// The report: a well-formed page whose every link leads to a file beside it.
#include "plots/report/report.hpp"

#include <cstddef>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "gl/error.hpp"
#include "tests/algorithms/scene/folder_test.hpp"

namespace pellucid::plots {
namespace {

/// Reads a page as strictly as an XML parser would, but for void elements; notes the first thing wrong.
class Page {
 public:
  explicit Page(const std::string& html) : html_(html) { read(); }
  std::string wrong;
  std::vector<std::string> links;  ///< of href and src, decoded
  std::set<std::string> ids;
  std::map<std::string, int> elements;
  std::string text;  ///< between the tags, decoded, style left out

 private:
  void fail(const std::string& what) {
    if (wrong.empty()) wrong = what + " near '" + html_.substr(at_ > 20 ? at_ - 20 : 0, 60) + "'";
  }
  std::string decode(std::string_view raw) {
    static const std::map<std::string_view, char> kEntities{{"amp", '&'}, {"lt", '<'}, {"gt", '>'}, {"quot", '"'}};
    std::string out;
    for (std::size_t i = 0; i < raw.size(); ++i) {
      if (raw[i] == '<' || raw[i] == '>') fail("a bare < or >");
      if (raw[i] != '&') {
        out += raw[i];
        continue;
      }
      const std::size_t end = raw.find(';', i);
      const auto entity = kEntities.find(raw.substr(i + 1, end - i - 1));
      if (end == std::string_view::npos || entity == kEntities.end()) {
        fail("a bare &");
        return out;
      }
      out += entity->second;
      i = end;
    }
    return out;
  }
  void read() {
    std::vector<std::string> open;
    if (!html_.starts_with("<!DOCTYPE html>")) fail("no doctype");
    at_ = std::string("<!DOCTYPE html>").size();
    while (at_ < html_.size() && wrong.empty()) {
      const std::size_t tag = html_.find('<', at_);
      const std::string_view between = std::string_view(html_).substr(at_, tag - at_);
      if (open.empty() || open.back() != "style") text += decode(between);
      if (tag == std::string::npos) break;
      const std::size_t end = html_.find('>', tag);
      if (end == std::string::npos) return fail("an open tag");
      at_ = end + 1;
      std::string_view inside = std::string_view(html_).substr(tag + 1, end - tag - 1);
      if (inside.starts_with('/')) {
        if (open.empty() || open.back() != inside.substr(1)) return fail("</" + std::string(inside.substr(1)) + ">");
        open.pop_back();
        continue;
      }
      const std::size_t space = inside.find(' ');
      const std::string name(inside.substr(0, space));
      ++elements[name];
      attributes(space == std::string_view::npos ? std::string_view() : inside.substr(space));
      if (name != "meta" && name != "img") open.push_back(name);
    }
    if (!open.empty()) fail("<" + open.back() + "> is never closed;");
  }
  void attributes(std::string_view rest) {
    while (!rest.empty()) {
      const std::size_t name = rest.find_first_not_of(' ');
      const std::size_t quote = rest.find("=\"");
      const std::size_t end = quote == std::string_view::npos ? quote : rest.find('"', quote + 2);
      if (end == std::string_view::npos) return fail("an attribute without quotes");
      const std::string key(rest.substr(name, quote - name));
      const std::string value = decode(rest.substr(quote + 2, end - quote - 2));
      if (key == "href" || key == "src") links.push_back(unescape(value));
      if (key == "id" && !ids.insert(value).second) fail("id " + value + " twice");
      rest.remove_prefix(end + 1);
    }
  }
  static std::string unescape(const std::string& url) {
    std::string out;
    for (std::size_t i = 0; i < url.size(); ++i) {
      if (url[i] == '%') {
        out += static_cast<char>(std::stoi(url.substr(i + 1, 2), nullptr, 16));
        i += 2;
      } else {
        out += url[i];
      }
    }
    return out;
  }
  const std::string& html_;
  std::size_t at_ = 0;
};

class WrittenReport : public test::FolderTest {
 protected:
  // Every kind of block, with text that would break a page if it went in as it is.
  Report tiny() const {
    Report report{"Fog & <trees>", "a \"lead\"", {}};
    ReportSection first{"paper", "What was run", {}};
    first.blocks.emplace_back(Heading{"1 < 2"});
    first.blocks.emplace_back(Paragraph{"a preview", true});
    first.blocks.emplace_back(Facts{{{"Device", "llvmpipe <256>"}, {"Driver", "Mesa & co"}}});
    first.blocks.emplace_back(CommandLine{"All", "pellucid render 'a & b' -s x=1 > \"log\""});
    ReportTable table{.caption = "Table 1", .rows = {{"hulls", "1", "2"}, {"fps", "50†", "<59>"}, {"FLIP", "0.1", ""}}};
    table.notes = {"Paper: 64 fps & more"};
    table.files = {{"CSV", "tables/table 1.csv"}};
    table.commands = {{"Again", "pellucid table t1"}};
    first.blocks.emplace_back(table);
    ReportSection second{"pictures", "Pictures", {}};
    ReportImage image{.path = "pictures/a#1 50%.png", .alt = "\"quoted\"", .title = "(a)", .caption = "M < N"};
    image.files = {{"EXR", "pictures/a.exr"}};
    ReportImage small{.path = "kept/big.exr", .alt = "kept", .thumbnail = "kept/small.png"};
    second.blocks.emplace_back(Gallery{{image, small}, 200});
    report.sections = {first, second};
    return report;
  }
  void write_files() const {
    for (const std::string& name : linked_files(tiny())) {
      std::filesystem::create_directories(file(name).parent_path());
      write(name, "x");
    }
  }
};

TEST_F(WrittenReport, IsWellFormedWithEveryKindOfBlock) {
  const std::string html = to_html(tiny());
  const Page page(html);
  EXPECT_EQ(page.wrong, "");
  EXPECT_EQ(page.elements.at("section"), 2);
  EXPECT_EQ(page.elements.at("img"), 2);
  EXPECT_EQ(page.elements.at("tr"), 3);
  EXPECT_EQ(page.elements.at("td"), 4);
  EXPECT_EQ(page.elements.at("th"), 5);
}

TEST_F(WrittenReport, SaysWhatItWasGiven) {
  const std::string html = to_html(tiny());
  const Page page(html);
  for (const char* words : {"Fog & <trees>", "a \"lead\"", "1 < 2", "llvmpipe <256>", "Mesa & co", "50†", "<59>",
                            "Paper: 64 fps & more", "pellucid render 'a & b' -s x=1 > \"log\"", "M < N"})
    EXPECT_NE(page.text.find(words), std::string::npos) << words;
}

TEST_F(WrittenReport, LinksLeadToTheFilesAndNowhereElse) {
  write_files();
  const auto path = file("index.html");
  write_report(tiny(), path);
  std::ifstream in(path);
  const std::string html((std::istreambuf_iterator<char>(in)), {});
  const Page page(html);
  ASSERT_EQ(page.wrong, "");
  std::set<std::string> files;
  for (const std::string& link : page.links) {
    if (link.starts_with('#')) {
      EXPECT_TRUE(page.ids.contains(link.substr(1))) << link;
    } else {
      EXPECT_TRUE(std::filesystem::is_regular_file(file(link))) << link;
      files.insert(link);
    }
  }
  EXPECT_EQ(files, (std::set<std::string>{"pictures/a#1 50%.png", "pictures/a.exr", "tables/table 1.csv",
                                          "kept/big.exr", "kept/small.png"}));
  EXPECT_EQ(html.find("http"), std::string::npos) << "the page must work without a network";
  EXPECT_EQ(html.find("<script"), std::string::npos);
}

TEST_F(WrittenReport, IsNotWrittenWhenAFileIsMissing) {
  write_files();
  const auto path = write("index.html", "the page before");
  std::filesystem::remove(file("pictures/a.exr"));
  try {
    write_report(tiny(), path);
    FAIL() << "the page was written";
  } catch (const RuntimeError& e) {
    EXPECT_NE(std::string(e.what()).find("pictures/a.exr"), std::string::npos) << e.what();
  }
  std::ifstream in(path);
  EXPECT_EQ(std::string((std::istreambuf_iterator<char>(in)), {}), "the page before");
}

TEST_F(WrittenReport, AnAbsoluteLinkIsRefused) {
  write_files();
  Report report = tiny();
  ReportTable table{.caption = "", .rows = {{"a"}}, .files = {{"elsewhere", file("pictures/a.exr").string()}}};
  report.sections.front().blocks.emplace_back(table);
  EXPECT_THROW(write_report(report, file("index.html")), RuntimeError);
}

TEST_F(WrittenReport, AnEmptyReportIsAPageToo) {
  const std::string html = to_html({});
  EXPECT_EQ(Page(html).wrong, "");
  EXPECT_TRUE(linked_files({}).empty());
}

}  // namespace
}  // namespace pellucid::plots
