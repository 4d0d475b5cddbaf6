// Units that tests of frames use.
#pragma once

#include "tin/frame/frame.h"

namespace tin::frame {

inline constexpr GroundScale kMetres{false, 1};
inline constexpr GroundScale kDegrees{true, 1};

}  // namespace tin::frame
