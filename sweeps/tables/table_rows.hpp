#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "sweeps/store/rows.hpp"
#include "sweeps/tables/tables.hpp"

/// What every table does with the rows of a store before it fills its own places. For the tables' own files.
namespace pellucid::sweeps {

/// The rows that a table may use: of one sweep, one device and one driver, each measurement once.
using ChosenRows = SweepRows;

/// See make_table.
ChosenRows choose_rows(const TableInfo&, const std::vector<nlohmann::json>& rows, std::string_view device);

/// The row with these whole-number parameters, or null. Throws InputError when two claim the place.
const nlohmann::json* find_row(const ChosenRows&, std::string_view technique,
                               const std::vector<std::pair<std::string, std::int64_t>>& parameters);

/// The row of a block with these values (any of its fields), or null. Throws InputError when two claim the place.
const nlohmann::json* find_row_of(const ChosenRows&, std::string_view block,
                                  const std::vector<std::pair<std::string, Value>>& values);
/// The rows of the blocks whose names begin with one of these.
ChosenRows rows_of_blocks(const ChosenRows&, const std::vector<std::string>& prefixes);

/// Where the used rows come from: device, driver, size, clock, scene and what stands in, frames, commit, drift.
std::vector<std::string> provenance_notes(const TableInfo&, const ChosenRows&);

/// Published numbers of Imagire et al. 2007, Table 1, beside ours.
TableInfo sampling_hulls_table1_info();
Table sampling_hulls_table1(const TableInfo&, const ChosenRows&);

/// The frame rates that its Figs. 8 to 11 name, beside ours, with errors: n from 8 to 11.
TableInfo sampling_hulls_figure_info(int n);
Table sampling_hulls_fig8(const TableInfo&, const ChosenRows&);
Table sampling_hulls_fig9(const TableInfo&, const ChosenRows&);
Table sampling_hulls_fig10(const TableInfo&, const ChosenRows&);
Table sampling_hulls_fig11(const TableInfo&, const ChosenRows&);

/// Ours alone: hulls against slices of equally many samples, averaged occlusion in shadows, the paper's reference
/// against the exact one.
TableInfo sampling_hulls_equal_info();
Table sampling_hulls_equal(const TableInfo&, const ChosenRows&);
TableInfo sampling_hulls_shadows_info();
Table sampling_hulls_shadows(const TableInfo&, const ChosenRows&);
TableInfo sampling_hulls_references_info();
Table sampling_hulls_references(const TableInfo&, const ChosenRows&);

/// Errors of the pictures of Szirmay-Kalos et al. 2005, Figs. 5 to 7: n from 5 to 7.
TableInfo distance_impostors_figure_info(int n);
Table distance_impostors_fig5(const TableInfo&, const ChosenRows&);
Table distance_impostors_fig6(const TableInfo&, const ChosenRows&);
Table distance_impostors_fig7(const TableInfo&, const ChosenRows&);
/// The frame rates that its Figs. 10 to 15 name, beside ours.
TableInfo distance_impostors_rates_info();
Table distance_impostors_rates(const TableInfo&, const ChosenRows&);

/// Published numbers of Chan and Wang 2005, Table 2, beside ours, the errors of their figures, and what each of the
/// bounds of Sec. 2.1 brings, ours alone.
TableInfo geocube_table2_info();
Table geocube_table2(const TableInfo&, const ChosenRows&);
TableInfo geocube_fig16_info();
Table geocube_fig16(const TableInfo&, const ChosenRows&);
TableInfo geocube_bounds_info();
Table geocube_bounds(const TableInfo&, const ChosenRows&);

}  // namespace pellucid::sweeps
