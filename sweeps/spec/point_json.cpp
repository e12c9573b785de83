#include "sweeps/spec/point_json.hpp"

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "gl/error.hpp"

namespace pellucid::sweeps {

using nlohmann::json;

json value_to_json(const Value& value) {
  return std::visit([](const auto& v) { return json(v); }, value);
}

Value value_from_json(const json& value) {
  if (value.is_boolean()) return value.get<bool>();
  if (value.is_number_integer()) return value.get<std::int64_t>();
  if (value.is_number()) return value.get<double>();
  return value.get<std::string>();
}

json point_to_json(const Point& point) {
  json parameters = json::object();
  for (const auto& [name, value] : point.parameters)
    parameters[name] = value_to_json(value);
  return {{"id", point.id},
          {"technique", point.technique},
          {"scene", point.scene},
          {"view", point.view},
          {"width", point.size.width},
          {"height", point.size.height},
          {"parameters", parameters},
          {"metrics", point.metrics},
          {"timing",
           {{"enabled", point.timing.enabled},
            {"min_samples", point.timing.min_samples},
            {"max_samples", point.timing.max_samples},
            {"max_seconds", point.timing.max_seconds},
            {"relative_ci", point.timing.relative_ci}}},
          {"reference", to_json(point.reference)}};
}

Point point_from_json(const json& in) {
  try {
    Point point;
    point.id = in.at("id");
    point.technique = in.at("technique");
    point.scene = in.at("scene");
    point.view = in.at("view");
    point.size = {in.at("width"), in.at("height")};
    PointParameters::Table parameters;
    for (const auto& [name, value] : in.at("parameters").items())
      parameters[name] = value_from_json(value);
    point.parameters = PointParameters(parameters);
    point.metrics = in.at("metrics").get<std::vector<std::string>>();
    const json& timing = in.at("timing");
    point.timing = {timing.at("enabled"), timing.at("min_samples"), timing.at("max_samples"), timing.at("max_seconds"),
                    timing.at("relative_ci")};
    point.reference = reference_settings(in.at("reference"));
    return point;
  } catch (const json::exception& e) {
    throw RuntimeError(fmt::format("a point that the worker cannot read: {}", e.what()));
  }
}

}  // namespace pellucid::sweeps
