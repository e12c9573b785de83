#pragma once

#include <optional>

/// The renderer of a window: a process of its own, so that loading and precomputation never hold the window up, can be
/// cancelled at any moment, and a crash of the driver costs no more than a picture.
///
/// One JSON object a line. The window asks:
///   {"type": "render", "generation": n, "recipe": {…}, "memory": PATH, "maps": false, "counts": false,
///    "scene": false}
///   {"type": "reference", … the same, "samples": 4, "divide": 2}      the truth at a half of the size
///   {"type": "reload"}                                               the shaders
/// and is told:
///   {"type": "hello", "device": …, "driver": …}                      once
///   {"type": "phase", "generation": n, "words": …, "share": 0.4}     any number; the share done where it is known
///   {"type": "scene", "generation": n, "scene": …, "views": […], "parameters": […]}
///   {"type": "picture", "generation": n, …}                          its pixels are in the memory by then
///   {"type": "refused", "generation": n, "reason": …, "failed": false}
///   {"type": "shaders", "error": …}
/// It ends when its input ends, and after a failure that is not the state's fault.
namespace pellucid::sandbox {

int run_render_worker(std::optional<int> device);

}  // namespace pellucid::sandbox
