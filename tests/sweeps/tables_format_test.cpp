// Tables and rows as text: Markdown, CSV, LaTeX, JSON.
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "sweeps/tables/csv.hpp"
#include "sweeps/tables/tables.hpp"
#include "tests/sweeps/fake_known_names.hpp"

namespace pellucid::sweeps::test {
namespace {

using nlohmann::json;

/// Two columns with everything that a format must mind.
Table awkward() {
  Table table;
  table.info = {"a.table1", "a.table1", "50 % of R&D_1", "Author 2007, Table 1", "a_table1", "a_table1"};
  table.heading_rows = 1;
  table.rows = {{"n", {{"1", 1.0}, {"16", 16.0}}, TableRow::all},
                {"fps, \"ours\"", {{"8.12†", 8.125}, {"failed", {}}}, TableRow::all, Better::more},
                {"a|b × c", {{"1–2", {}}, {"", {}}}, TableRow::markdown | TableRow::latex},
                {"[low]", {{"x", 0.1}, {"", {}}}, TableRow::csv}};
  table.records = {{{"n", Value(std::int64_t{1})}, {"paper", Value(50.0)}, {"ours", Value(8.125)}},
                   {{"n", Value(std::int64_t{16})}, {"paper", std::nullopt}, {"ours", std::nullopt}}};
  table.notes = {"GPU_1 <a> {b} ~ ^ \\ # $ ünï → ≈"};
  table.sweep = "a_table1";
  return table;
}

TEST(TableFormats, MarkdownIsAligned) {
  EXPECT_EQ(format_table(awkward(), TableFormat::markdown),
            "**50 % of R&D_1** (Author 2007, Table 1)\n"
            "\n"
            "| n           |     1 |     16 |\n"
            "|:------------|------:|-------:|\n"
            "| fps, \"ours\" | 8.12† | failed |\n"
            "| a\\|b × c    |   1–2 |        |\n"
            "\n"
            "- GPU_1 \\<a\\> {b} ~ ^ \\\\ # $ ünï → ≈\n");
}

TEST(TableFormats, CsvFollowsRfc4180) {
  EXPECT_EQ(format_table(awkward(), TableFormat::csv),
            "n,1,16\r\n"
            "\"fps, \"\"ours\"\"\",8.125,failed\r\n"
            "[low],0.1,\r\n");
}

TEST(TableFormats, LatexSetsTheBestValueInBoldAndAlignsNumbers) {
  Table table = awkward();
  table.notes.clear();
  table.rows = {{"n", {{"1", 1.0}, {"two", {}}, {"3", 3.0}}, TableRow::all},
                {"fps (paper)", {{"9", 9.0}, {"", {}}, {"90", 90.0}}, TableRow::all},
                {"fps (ours)", {{"10.50", 10.5}, {"8.12†", 8.125}, {"failed", {}}}, TableRow::all, Better::more},
                {"FLIP", {{"0.200", 0.2}, {"0.100", 0.1}, {"0.100", 0.1}}, TableRow::all, Better::less},
                {"share", {{"0.3", 0.3}, {"0.4", 0.4}, {"0.5", 0.5}}, TableRow::all}};
  const auto lines = [&](const LatexOptions& options) {
    const std::string text = format_table(table, TableFormat::latex, options);
    const std::size_t from = text.find("\\begin{tabular}");
    return text.substr(from, text.find("    \\bottomrule") - from);
  };
  EXPECT_EQ(lines({.siunitx = false, .bold_best = true}),
            "\\begin{tabular}{lrrr}\n"
            "    \\toprule\n"
            "    n & 1 & two & 3 \\\\\n"
            "    \\midrule\n"
            "    fps (paper) & 9 &  & 90 \\\\\n"
            "    fps (ours) & \\textbf{10.50} & 8.12$^\\dagger$ & failed \\\\\n"
            "    FLIP & 0.200 & \\textbf{0.100} & \\textbf{0.100} \\\\\n"
            "    share & 0.3 & 0.4 & 0.5 \\\\\n");
  EXPECT_EQ(lines({.siunitx = true, .bold_best = true}),
            "\\begin{tabular}{l\n"
            "    S[table-format=2.3, detect-weight]\n"
            "    S[table-format=1.3, detect-weight]\n"
            "    S[table-format=2.3, detect-weight]}\n"
            "    \\toprule\n"
            "    n & {1} & {two} & {3} \\\\\n"
            "    \\midrule\n"
            "    fps (paper) & 9 &  & 90 \\\\\n"
            "    fps (ours) & \\bfseries 10.50 & {8.12$^\\dagger$} & {failed} \\\\\n"
            "    FLIP & 0.200 & \\bfseries 0.100 & \\bfseries 0.100 \\\\\n"
            "    share & 0.3 & 0.4 & 0.5 \\\\\n");
}

TEST(TableFormats, LatexEscapesAndUsesBooktabs) {
  EXPECT_EQ(format_table(awkward(), TableFormat::latex),
            R"(% a.table1 of Pellucid; needs \usepackage{booktabs}
\begin{table}
  \centering
  \caption{50 \% of R\&D\_1 (Author 2007, Table 1).}
  \label{tab:a.table1}
  \small\setlength{\tabcolsep}{3pt}
  \begin{tabular}{lrr}
    \toprule
    n & 1 & 16 \\
    \midrule
    fps, ''ours'' & 8.12$^\dagger$ & failed \\
    a$|$b $\times$ c & 1--2 &  \\
    \bottomrule
  \end{tabular}
  \par\smallskip
  \begin{minipage}{0.95\linewidth}
    \footnotesize\raggedright
    GPU\_1 $<$a$>$ \{b\} \textasciitilde{} \textasciicircum{} \textbackslash{} \# \$ ünï $\rightarrow$ [U+2248]\par
  \end{minipage}
\end{table}
)");
}

TEST(TableFormats, LatexDoesNotTakeALabelForAnArgumentOfALinesEnd) {
  Table table = awkward();
  table.rows[1].label = "[fps]";
  table.rows[2].label = "*";
  const std::string text = format_table(table, TableFormat::latex);
  EXPECT_NE(text.find("    {}[fps] & "), std::string::npos) << text;
  EXPECT_NE(text.find("    {}* & "), std::string::npos) << text;
}

TEST(TableFormats, BrokenUtf8IsNoTrap) {
  Table table = awkward();
  table.notes = {"a\xff\xc3", "\xe2\x80"};
  table.records[0][0].second = Value(std::string("a\xff"));
  EXPECT_NE(format_table(table, TableFormat::latex).find("a[U+FFFD][U+FFFD]"), std::string::npos);
  EXPECT_TRUE(json::accept(format_table(table, TableFormat::json)));
}

TEST(TableFormats, JsonIsAListOfRowsWithPaperAndOurs) {
  EXPECT_EQ(format_table(awkward(), TableFormat::json),
            "[\n"
            "  {\n    \"n\": 1,\n    \"paper\": 50.0,\n    \"ours\": 8.125\n  },\n"
            "  {\n    \"n\": 16,\n    \"paper\": null,\n    \"ours\": null\n  }\n"
            "]\n");
  const json list = json::parse(format_table(make_table("sampling_hulls.table1", {}), TableFormat::json));
  std::vector<int> paper;
  for (const json& row : list) {
    EXPECT_TRUE(row.at("ours").is_null());
    EXPECT_EQ(row.at("hulls").get<int>() * row.at("samples").get<int>(), 32);
    EXPECT_EQ(row.at("outcome"), "missing");
    paper.push_back(row.at("paper").get<int>());
  }
  EXPECT_EQ(paper, (std::vector<int>{50, 59, 64, 62, 55, 47}));
}

TEST(TableFormats, AreNamed) {
  EXPECT_EQ(parse_table_format("latex"), TableFormat::latex);
  const std::string error = input_error([] { parse_table_format("tex"); });
  for (const char* part : {"'tex'", "md", "csv", "latex", "json"})
    EXPECT_NE(error.find(part), std::string::npos) << error;
}

TEST(Csv, QuotesWhatNeedsIt) {
  EXPECT_EQ(csv_record({"a", "", "b,c", "d\"e", "f\ng", "h\ri", " j "}),
            "a,,\"b,c\",\"d\"\"e\",\"f\ng\",\"h\ri\", j \r\n");
}

TEST(Csv, RowsHaveColumnsInAFixedOrder) {
  const std::vector<json> rows{
      {{"rmse", 0.25},
       {"flip_mean", 0.5},
       {"hulls", 4},
       {"scene.density", 1.5},
       {"pass_ms", {{"fog", 2.5}, {"opaque", 1}}},
       {"fps", 100.0},
       {"frame_ms_median", 10.0},
       {"dirty", true},
       {"device", "A, \"B\""},
       {"argv", {"pellucid", "sweep"}},
       {"sweep", "s"},
       {"status", "ok"},
       {"width", 64}},
      {{"sweep", "s"}, {"status", "failed"}, {"failure", "it hung"}, {"slices", 8}, {"rmse", nullptr}}};
  EXPECT_EQ(
      rows_to_csv(rows),
      "sweep,block,point,technique,scene,view,width,height,status,failure,hulls,scene.density,slices,"
      "frame_ms_median,fps,pass_ms.fog,pass_ms.opaque,flip_mean,rmse,device,dirty,argv\r\n"
      "s,,,,,,64,,ok,,4,1.5,,10.0,100.0,2.5,1,0.5,0.25,\"A, \"\"B\"\"\",true,\"[\"\"pellucid\"\",\"\"sweep\"\"]\"\r\n"
      "s,,,,,,,,failed,it hung,,,8,,,,,,,,,\r\n");
  EXPECT_EQ(rows_to_csv({}), "sweep,block,point,technique,scene,view,width,height,status,failure\r\n");
}

}  // namespace
}  // namespace pellucid::sweeps::test
