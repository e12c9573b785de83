# Writes OUT with the commit of ROOT and whether its tree has changes; leaves OUT alone when nothing changed.
find_program(GIT git)
set(COMMIT unknown)
set(DIRTY false)
if(GIT)
  # The tree may belong to someone else, as in a container.
  set(ask ${GIT} -c safe.directory=* -C ${ROOT})
  execute_process(COMMAND ${ask} rev-parse HEAD OUTPUT_VARIABLE found RESULT_VARIABLE status ERROR_QUIET OUTPUT_STRIP_TRAILING_WHITESPACE)
  if(status EQUAL 0)
    set(COMMIT ${found})
    execute_process(COMMAND ${ask} --no-optional-locks status --porcelain OUTPUT_VARIABLE changes ERROR_QUIET)
    if(NOT changes STREQUAL "")
      set(DIRTY true)
    endif()
  endif()
endif()
file(CONFIGURE OUTPUT ${OUT} @ONLY CONTENT [[
#include "sweeps/spec/provenance.hpp"

namespace pellucid::sweeps {

const char* const kCommit = "@COMMIT@";
const bool kDirty = @DIRTY@;

}  // namespace pellucid::sweeps
]])
