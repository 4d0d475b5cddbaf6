// The contract, proto/openapi.json, as it was when this program was built.
#pragma once

#include <string>
#include <string_view>

namespace proto {

/// The text of the document; lives as long as the program.
std::string_view openapi_json();

/// The part of it that is about one TIN, as the API of a service at `url`: "/tins/{tin}/collections" is "/collections" there.
std::string tin_openapi_json(std::string_view url);

}  // namespace proto
