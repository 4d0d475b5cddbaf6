// What a browser gets at "/".
#pragma once

#include <string_view>

namespace server::web {

std::string_view index_html();

}  // namespace server::web
