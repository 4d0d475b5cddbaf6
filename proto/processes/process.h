// What every process has in common on the wire: its description and the request that executes it
// (OGC API Processes 1.0).
//
// A process has one output, "result", which is a JSON value. Asked for raw, as is the rule, that value is the
// answer; asked for as a document, it stands in an object under its name.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "proto/json_read.h"
#include "tin/base/result.h"

namespace proto {

/// What a process says of itself. Line breaks in the JSON texts are left out when they are sent.
struct ProcessDescription {
  std::string_view id;
  std::string_view title;
  std::string_view description;
  std::string_view inputs;         // a JSON object: name to input description
  std::string_view result_title;   // of the output "result"
  std::string_view result_schema;  // a JSON Schema in the manner of OpenAPI 3.0
};

/// Paths in the links of both are relative to the server's root, for example "/processes/simplify".
std::string process_list_json(std::span<const ProcessDescription* const> processes);
std::string process_json(const ProcessDescription& process);

/// POST /processes/{process}/execution, whatever the process.
class ExecutionRequest {
 public:
  /// Errors: kMalformed, kInvalidValue (an output that there is not, a transmission by reference).
  static tin::base::Result<ExecutionRequest> read(std::string_view body);

  /// The member "inputs", an object; its errors say "/inputs/...". Valid as long as this request.
  Value inputs() const;
  /// Whether the result is to stand in a document: {"result": ...}.
  bool as_document() const { return as_document_; }

 private:
  explicit ExecutionRequest(Document document) : document_(std::move(document)) {}
  Document document_;
  bool as_document_ = false;
};

/// {"result": ...} around a JSON value.
std::string result_document(std::string_view result);

// What inputs of several processes are made of.

/// The id of a TIN under `name`, if it is there. Errors: kMalformed, kInvalidValue.
tin::base::Result<std::optional<std::string>> read_optional_tin_id(const Object& inputs,
                                                                   std::string_view name);
/// The same where it must be there.
tin::base::Result<std::string> read_tin_id(const Object& inputs, std::string_view name);

}  // namespace proto
