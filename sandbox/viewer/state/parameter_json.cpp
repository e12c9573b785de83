#include "sandbox/viewer/state/parameter_json.hpp"

#include <cstdint>
#include <string>
#include <utility>
#include <variant>

#include <nlohmann/json.hpp>

#include "sweeps/spec/point_json.hpp"

namespace pellucid::sandbox {

using nlohmann::json;
using nlohmann::ordered_json;

ordered_json parameters_json(std::span<const ParameterInfo> infos) {
  ordered_json out = ordered_json::array();
  for (const ParameterInfo& p : infos) {
    ordered_json entry{
        {"name", p.name}, {"type", name(p.type)}, {"default", ordered_json(sweeps::value_to_json(p.default_value))}};
    if (p.type == ValueType::choice) entry["choices"] = p.choices;
    if (p.type == ValueType::integer || p.type == ValueType::real) {
      entry["min"] = p.min;
      entry["max"] = p.max;
    }
    entry["unit"] = p.unit;
    entry["symbol"] = p.symbol;
    entry["cite"] = p.cite;
    entry["change"] = name(p.when);
    entry["doc"] = p.doc;
    out.push_back(std::move(entry));
  }
  return out;
}

std::vector<ParameterInfo> parameters_from_json(const json& in) {
  std::vector<ParameterInfo> out;
  for (const json& entry : in) {
    ParameterInfo info;
    info.name = entry.at("name");
    const std::string type = entry.at("type");
    for (const ValueType known : {ValueType::boolean, ValueType::integer, ValueType::real, ValueType::choice})
      if (type == name(known)) info.type = known;
    const std::string change = entry.at("change");
    for (const Change known : {Change::uniform, Change::program, Change::precompute})
      if (change == name(known)) info.when = known;
    info.default_value = sweeps::value_from_json(entry.at("default"));
    // A real default that is whole, such as 2, comes back as an integer.
    if (const auto* whole = std::get_if<std::int64_t>(&info.default_value);
        whole != nullptr && info.type == ValueType::real)
      info.default_value = static_cast<double>(*whole);
    info.choices = entry.value("choices", std::vector<std::string>{});
    info.min = entry.value("min", 0.0);
    info.max = entry.value("max", 0.0);
    info.unit = entry.at("unit");
    info.symbol = entry.at("symbol");
    info.cite = entry.at("cite");
    info.doc = entry.at("doc");
    out.push_back(std::move(info));
  }
  return out;
}

}  // namespace pellucid::sandbox
