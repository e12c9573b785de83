#pragma once

#include <map>
#include <string>

namespace pellucid::gl {

/// The objects that live in a context, whoever made them: "texture 'panel'" to the number of such.
using LiveObjects = std::map<std::string, int>;

/// Those of the current context. It asks GL for each name, so it costs milliseconds and is for searching leaks.
LiveObjects count_live_objects();

/// All together.
int total(const LiveObjects&);

/// Those of which there are more than before: "2 × texture 'panel', 1 × buffer ''"; empty when there are none.
std::string growth(const LiveObjects& before, const LiveObjects& after);

}  // namespace pellucid::gl
