#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

/// The messages between parent and worker, one JSON object per line.
///
///   worker → parent   {"type": "hello", "protocol": 1, "device": …, "driver": …, "clock": …}    once, when it can
///   render parent → worker   {"type": "measure", "point": {…}, "references": FOLDER, "picture": FILE}  a point, in
///   full; with
///                                                                                               `picture`, kept
///                     {"type": "reference", "point": {…}, "references": FOLDER}                 its reference alone
///                     {"type": "time", "point": {…}}                                            its frame time alone
///                     Each may have "unix_minus_boot_s" (sweeps/spec/clock.hpp).
///   worker → parent   {"type": "progress", "phase": "reference", "share": 0.4}                  any number
///                     {"type": "done", "id": …, "row": {…}, "frame_ms_samples": […]}
///                     {"type": "failed", "id": …, "reason": …}
///
/// The worker ends when its input ends. Its standard error is kept for the reason of a crash.
namespace pellucid::sweeps {

inline constexpr int kProtocol = 1;

/// One line without the newline; text that is not UTF-8 is mended.
std::string to_line(const nlohmann::json&);

}  // namespace pellucid::sweeps
