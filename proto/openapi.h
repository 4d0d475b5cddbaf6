// The contract, proto/openapi.json, as it was when this program was built.
#pragma once

#include <string_view>

namespace proto {

/// The text of the document; lives as long as the program.
std::string_view openapi_json();

}  // namespace proto
