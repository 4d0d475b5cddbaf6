// What proto/openapi.json promises, and whether an answer keeps it.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "tests/support/http_client.h"

namespace tests::contract {

using support::Ask;
using support::RawAnswer;

/// "GET /tins/{tin}": the documented operation that a method and target belong to; "" if there is none.
std::string operation_of(const Ask& ask);

/// All that is wrong with an answer, a line each: CORS, ETag and other documented header fields, media type,
/// schema, and the form of problem documents. Answers to OPTIONS, and 304, need no documentation.
std::vector<std::string> breaches(const Ask& ask, const RawAnswer& answer);

/// The names of the operation's query parameters.
std::set<std::string> documented_query(const std::string& operation);
std::set<std::string> documented_path_parameters(const std::string& operation);
bool documents_a_body(const std::string& operation);
/// "GET /tins 200" and so on: every status that the document lists by its number.
std::set<std::string> documented_statuses();

}  // namespace tests::contract
