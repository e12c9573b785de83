// Tables of the figures of sampling hulls: published frame rates, ours beside them, errors and their ratios.
#include <algorithm>
#include <cstddef>
#include <stdexcept>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "sweeps/spec/plan.hpp"
#include "sweeps/tables/tables.hpp"
#include "tests/sweeps/fake_known_names.hpp"
#include "tests/sweeps/table_texts.hpp"

namespace pellucid::sweeps::test {
namespace {

using nlohmann::json;
using Words = std::vector<std::string>;

json row(const char* sweep, const std::string& block, const char* technique, json fields) {
  json out{{"sweep", sweep},      {"block", block},  {"technique", technique}, {"scene", "statue_spotlight"},
           {"view", "front"},     {"width", 720},    {"height", 540},          {"status", "ok"},
           {"timing", "off"},     {"device", "GPU"}, {"driver", "4.5 A"},      {"commit", "0123456789abcdef"},
           {"flip_mean", 0.0125}, {"rmse", 0.00123}, {"dirty", false}};
  out.update(fields);
  out["point"] = block + out.dump();
  return out;
}

json timed(json fields, double frame_ms) {
  fields["timing"] = "converged";
  fields["frame_ms_median"] = frame_ms;
  fields["frame_ms_ci95_low"] = 0.9 * frame_ms;
  fields["frame_ms_ci95_high"] = 1.1 * frame_ms;
  fields["fps"] = 1000 / frame_ms;
  fields["frames"] = 30;
  fields["clock"] = "gpu_query";
  return fields;
}

// ---- Figs. 8 to 11 ----

TEST(FigureTables, PublishedFrameRatesAreThePapers) {
  // Imagire et al. 2007: text of Sec. 5, and the tables in the captions of Figs. 10 and 11.
  EXPECT_EQ(texts(make_table("sampling_hulls.fig8", {}), "fps (paper)"), (Words{"", "64", "", "26"}));
  EXPECT_EQ(texts(make_table("sampling_hulls.fig9", {}), "fps (paper)"), (Words{"96", "96", "96", ""}));
  EXPECT_EQ(texts(make_table("sampling_hulls.fig10", {}), "fps (paper)"), (Words{"82", "82", "68", ""}));
  EXPECT_EQ(texts(make_table("sampling_hulls.fig11", {}), "fps (paper)"), (Words{"77", "203", "77", "203"}));
  EXPECT_EQ(texts(make_table("sampling_hulls.fig8", {}), "Method"),
            (Words{"2 × 4 hulls", "4 × 8 hulls", "128 slices", "512 slices"}));
  EXPECT_EQ(texts(make_table("sampling_hulls.fig9", {}), "Method"),
            (Words{"2 × 8 hulls", "2 × 8 hulls", "64 slices", "64 slices"}));
  EXPECT_EQ(texts(make_table("sampling_hulls.fig10", {}), "Method"),
            (Words{"4 × 4 hulls", "4 × 4 hulls", "32 slices", "32 slices"}));
  EXPECT_EQ(texts(make_table("sampling_hulls.fig11", {}), "Method"),
            (Words{"8 × 8 hulls", "64 slices", "8 × 8 hulls", "64 slices"}));
  EXPECT_EQ(texts(make_table("sampling_hulls.fig10", {}), "fps over the slices' (paper)"), (Words{"1.21", "", "", ""}));
  EXPECT_EQ(texts(make_table("sampling_hulls.fig11", {}), "fps over the slices' (paper)"),
            (Words{"0.38", "", "0.38", ""}));
}

TEST(FigureTables, ANameNeedsNoPaperWhereOneAloneHasIt) {
  EXPECT_EQ(find_table("fig11").name, "sampling_hulls.fig11");
  EXPECT_NE(input_error([] { find_table("fig111"); }).find("no table named 'fig111'"), std::string::npos);
}

TEST(FigureTables, OursComeFromTheFiguresOwnBlocksViewsAndMoments) {
  constexpr const char* kSweep = "sampling_hulls_figures";
  const json hulls{{"hulls", 8}, {"samples", 8}}, slices{{"slices", 64}};
  const auto with = [](json fields, const json& more) {
    fields.update(more);
    return fields;
  };
  const std::vector<json> rows{
      row(kSweep, "fig11_hulls", "sampling_hulls",
          timed(with(hulls, {{"flip_mean", 0.02}, {"flip_mean_shadow", 0.04}, {"shadow_pixels_share", 0.2}}), 10)),
      row(kSweep, "fig11_slices", "volume_slices", timed(with(slices, {{"flip_mean", 0.03}}), 5)),
      row(kSweep, "fig11_hulls", "sampling_hulls", timed(with(hulls, {{"view", "shadow"}, {"flip_mean", 0.5}}), 20)),
      row(kSweep, "fig11_by_slices", "sampling_hulls", with(hulls, {{"flip_mean", 0.07}})),
      row(kSweep, "fig10_hulls", "sampling_hulls", timed({{"hulls", 8}, {"samples", 8}, {"scene.time_s", 0.0}}, 99)),
  };
  const Table table = make_table("fig11", rows);
  EXPECT_EQ(texts(table, "fps (ours)"), (Words{"100.0", "200.0", "50.00", ""}));
  EXPECT_EQ(texts(table, "fps over the slices' (ours)"), (Words{"0.50", "", "", ""}));
  EXPECT_EQ(texts(table, "FLIP"), (Words{"0.0200", "0.0300", "0.500", ""}));
  EXPECT_EQ(texts(table, "FLIP in shadows"), (Words{"0.0400", "", "", ""}));
  EXPECT_EQ(texts(table, "FLIP by 1,024 slices"), (Words{"0.0700", "", "", ""}));
  EXPECT_TRUE(noted(table, "In shadows: where the shadows in the medium take more than 5 %"));
  EXPECT_TRUE(noted(table, "Not measured yet: (d) 64 slices."));
  EXPECT_FALSE(noted(table, "teapot"));
  ASSERT_EQ(table.records.size(), 4U);
  const json records = json::parse(format_table(table, TableFormat::json));
  EXPECT_EQ(records[0].at("paper"), 77);
  EXPECT_EQ(records[0].at("ours"), 100.0);
  EXPECT_EQ(records[0].at("flip_mean_by_slices"), 0.07);
  EXPECT_EQ(records[3].at("ours"), nullptr);
  EXPECT_EQ(records[1].at("technique"), "volume_slices");
  // The moment tells two pictures of Fig. 10 apart.
  const Table other = make_table("fig10", {row(kSweep, "fig10_hulls", "sampling_hulls",
                                               timed({{"hulls", 4}, {"samples", 4}, {"scene.time_s", 5.0}}, 10))});
  EXPECT_EQ(texts(other, "fps (ours)"), (Words{"", "100.0", "", ""}));
}

// ---- errors ----

TEST(ErrorTables, EqualCountsAreDivided) {
  constexpr const char* kSweep = "sampling_hulls_equal_preview";
  const auto of = [&](const char* block, const char* scene, json fields, double flip) {
    fields["scene"] = scene;
    fields["flip_mean"] = flip;
    return row(kSweep, block, std::string(block).starts_with("hulls") ? "sampling_hulls" : "volume_slices", fields);
  };
  const std::vector<json> rows{
      of("slices", "fog_forest", {{"slices", 8}}, 0.10),
      of("hulls", "fog_forest", {{"hulls", 2}, {"samples", 4}}, 0.04),
      of("slices", "statue_spotlight_procedural", {{"slices", 8}}, 0.10),
      of("slices_single", "statue_spotlight_procedural", {{"slices", 8}}, 0.08),
      of("hulls", "statue_spotlight_procedural", {{"hulls", 2}, {"samples", 4}}, 0.06),
      of("hulls_middle", "statue_spotlight_procedural", {{"hulls", 2}, {"samples", 4}}, 0.05),
      of("hulls_middle_single", "statue_spotlight_procedural", {{"hulls", 2}, {"samples", 4}}, 0.02),
  };
  const Table table = make_table("sampling_hulls.equal", rows);
  EXPECT_EQ(texts(table, "Fig. 8, points at the back, as in the paper: ratio")[0], "0.40");
  EXPECT_EQ(texts(table, "Fig. 11, points at the back, as in the paper: ratio")[0], "0.60");
  EXPECT_EQ(texts(table, "Fig. 11, points in the middle: ratio")[0], "0.50");
  EXPECT_EQ(texts(table, "Fig. 11, points in the middle, 32-bit floats: ratio")[0], "0.25")
      << "against slices in 32 bits";
  EXPECT_EQ(texts(table, "Fig. 8, points in the middle: ratio")[0], "");
}

TEST(ErrorTables, ShadowsDivideAveragedByOneRate) {
  constexpr const char* kSweep = "sampling_hulls_shadows";
  const auto of = [&](const char* block, double flip, double rmse) {
    return row(kSweep, block, "sampling_hulls",
               {{"hulls", 8}, {"samples", 8}, {"flip_mean_shadow", flip}, {"rmse_shadow", rmse}});
  };
  const Table table = make_table(
      "sampling_hulls.shadows",
      {of("fig11_counts_back", 0.03, 0.2), of("fig11_counts_back_unfiltered", 0.04, 0.1), of("fig11_hulls", 0.9, 0.9)});
  EXPECT_EQ(texts(table, "Fig. 11, points at the back: FLIP, ratio"), (Words{"", "", "", "0.75", ""}));
  EXPECT_EQ(texts(table, "Fig. 11, points at the back: RMSE, ratio"), (Words{"", "", "", "2.00", ""}));
}

TEST(ErrorTables, ReferencesStandApart) {
  constexpr const char* kSweep = "sampling_hulls_figures";
  const json hulls{{"hulls", 8}, {"samples", 8}, {"view", "shadow"}};
  json half = hulls, single = hulls;
  half.update({{"reference_to_exact_flip_mean", 0.15}, {"reference_to_exact_rmse", 0.02}, {"flip_mean", 0.16}});
  single.update({{"reference_to_exact_flip_mean", 0.01}, {"reference_to_exact_rmse", 0.001}, {"flip_mean", 0.02}});
  const Table table =
      make_table("sampling_hulls.references", {row(kSweep, "fig11_by_slices", "sampling_hulls", half),
                                               row(kSweep, "fig11_by_slices_single", "sampling_hulls", single),
                                               row(kSweep, "fig11_hulls", "sampling_hulls", hulls)});
  EXPECT_EQ(texts(table, "1,024 slices in a 16-bit frame: FLIP from the exact")[6], "0.150");
  EXPECT_EQ(texts(table, "1,024 slices in a 32-bit frame: RMSE from the exact")[6], "0.00100");
  EXPECT_EQ(texts(table, "The paper's hulls: FLIP by the exact reference")[6], "0.0125");
  EXPECT_EQ(texts(table, "The paper's hulls: FLIP by 1,024 slices, 32-bit")[6], "0.0200");
  EXPECT_EQ(texts(table, "The paper's hulls: FLIP by 1,024 slices, 32-bit")[0], "");
}

// ---- the specs that fill them ----

/// A store that holds a row for every point of a spec fills its tables without a gap.
TEST(FigureSpecs, FillTheirTables) {
  Words lacking;
  for (const char* spec_name : {"sampling_hulls_figures", "sampling_hulls_equal", "sampling_hulls_shadows"}) {
    if (lacks_assets(spec_name)) {
      lacking.emplace_back(spec_name);
      continue;
    }
    const Plan plan = make_plan(load_spec(spec_name));
    std::vector<json> rows;
    for (const Member& member : plan.members) {
      const Point& point = plan.points[member.point];
      json fields{{"view", point.view}, {"scene", point.scene}, {"flip_mean_shadow", 0.01}, {"rmse_shadow", 0.02}};
      for (const auto& [name, value] : point.parameters)
        fields[name] = std::visit([](const auto& v) { return json(v); }, value);
      if (point.reference.method == ReferenceMethod::slices)
        fields.update({{"reference_to_exact_flip_mean", 0.1}, {"reference_to_exact_rmse", 0.01}});
      json made = row(spec_name, member.block, point.technique.c_str(),
                      point.timing.enabled ? timed(std::move(fields), 10) : fields);
      made["point"] = point.id;
      rows.push_back(std::move(made));
    }
    for (const TableInfo& info : tables()) {
      if (info.spec != spec_name) continue;
      const Table table = make_table(info.name, rows);
      EXPECT_FALSE(noted(table, "Not measured yet")) << info.name;
      for (const TableRow& r : table.rows) {
        if (r.label.find("(paper)") != std::string::npos || r.label == "Picture" || r.label.find("slices") == 0)
          continue;
        const bool partly = r.label.starts_with("fps over") || r.label.ends_with("by 1,024 slices");
        for (std::size_t i = 0; i < r.cells.size(); ++i)
          EXPECT_TRUE(partly || !r.cells[i].text.empty()) << info.name << ": " << r.label << ", column " << i;
      }
    }
  }
  if (!lacking.empty()) GTEST_SKIP() << "no assets for " << lacking.size() << " specs, among them " << lacking.front();
}

TEST(FigureSpecs, PreviewsNeedNoAssets) {
  for (const std::string& name : list_specs()) {
    if (!name.starts_with("sampling_hulls") || !name.ends_with("_preview")) continue;
    for (const Point& point : make_plan(load_spec(name)).points) {
      EXPECT_NE(point.scene, "water_tank") << name;
      EXPECT_NE(point.scene, "statue_spotlight") << name;
    }
  }
}

}  // namespace
}  // namespace pellucid::sweeps::test
