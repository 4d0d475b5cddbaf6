// Where encoded bytes go that are too many for one string.
#pragma once

#include <functional>
#include <string_view>

#include "tin/base/result.h"

namespace tin::codec {

/// Takes the next piece; an error ends the encoding.
using Sink = std::function<base::Result<void>(std::string_view piece)>;

}  // namespace tin::codec
