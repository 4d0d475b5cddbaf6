// Text within XML and HTML.
#pragma once

#include <string>
#include <string_view>

namespace proto {

/// With &, <, >, " and ' as entities that XML and HTML both know.
std::string escaped_markup(std::string_view text);

}  // namespace proto
