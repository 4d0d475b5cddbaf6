// JSON Schemas of the features of a TIN's collections (OGC API Features Part 5, a draft).
#pragma once

#include <string>
#include <string_view>

namespace proto {

inline constexpr std::string_view kSchemaMediaType = "application/schema+json";

/// The schema of "vertices", "triangles" or "edges"; `id` is its own URL.
std::string collection_schema_json(std::string_view collection, std::string_view id);

}  // namespace proto
