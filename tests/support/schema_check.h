// Whether a JSON text is what proto/openapi.json promises, for contract tests.
//
//   const auto wrong = violations("GET", "/tins/{tin}", 200, body);
//   EXPECT_THAT(wrong, IsEmpty());
//
// Stricter than the document itself: an object that lists its properties has no others, so that every member
// of an answer is documented.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace tests_support {

/// What is wrong with `body` as the answer to `method` on `path_template` with `status`: one line for each
/// violation, empty when all is well. An undocumented operation, status or media type is a violation. A
/// status that is not listed is held against the "default" response. Without `media_type` the response's only
/// JSON type is meant.
std::vector<std::string> violations(std::string_view method, std::string_view path_template, int status,
                                    std::string_view body, std::string_view media_type = {});

/// The same for a JSON body of a request.
std::vector<std::string> request_violations(std::string_view method, std::string_view path_template,
                                            std::string_view body);

/// The same for a schema of components/schemas, by its name.
std::vector<std::string> schema_violations(std::string_view schema_name, std::string_view body);

/// Every example in the document that does not fit the schema beside it, and schemas that cannot be read.
std::vector<std::string> example_violations();

/// "GET /tins/{tin}" and so on: every operation of the document.
std::vector<std::string> documented_operations();

}  // namespace tests_support
