#pragma once

#include <OpenColorIO/OpenColorIO.h>

namespace pellucid::gl {

/// The same processor with its neighbouring RGB curves (GradingRGBCurve, the tone curves of ACES) as one table, for
/// drawing: OpenColorIO's shader looks for the piece of each curve in a loop over arrays, six times per pixel, which is
/// half of the whole transform where the processor rasterises. The table has 8,192 entries and is interpolated
/// linearly; a processor whose curves it would miss by more than 1e-5, or that has none, comes back as it is.
OCIO_NAMESPACE::ConstProcessorRcPtr with_tabulated_curves(const OCIO_NAMESPACE::ConstConfigRcPtr&,
                                                          const OCIO_NAMESPACE::ConstProcessorRcPtr&);

}  // namespace pellucid::gl
