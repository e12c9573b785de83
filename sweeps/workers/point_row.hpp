#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

#include "sweeps/spec/plan.hpp"
#include "sweeps/workers/worker_client.hpp"

/// The part of a row that the parent adds to a worker's answer, and what it says of a row.
namespace pellucid::sweeps {

/// "volume_slices fog_forest slices=64 720x540"
std::string summary_of(const Point&);
/// "1.25 ms, flip_mean 0.02"
std::string outcome_of(const nlohmann::json& row);
/// Why a row that a worker calls done is not; empty when it is sound.
std::string flaw_of(const nlohmann::json& row, const Point&);

/// The conditions of the measurement: parameters, scene, size, code and the command that repeats it.
void put_point(nlohmann::json& row, const Point&);
void put_machine(nlohmann::json& row, const WorkerClient::Hello&, const std::string& host);
/// `failure`: empty for a row that is sound.
void put_outcome(nlohmann::json& row, const std::string& failure, double started_unix_s, double wall_s);

}  // namespace pellucid::sweeps
