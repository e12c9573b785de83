#include "sweeps/workers/worker_protocol.hpp"

#include <nlohmann/json.hpp>

namespace pellucid::sweeps {

std::string to_line(const nlohmann::json& message) {
  return message.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

}  // namespace pellucid::sweeps
