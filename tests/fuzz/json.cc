// Checked JSON and the messages made of it. Whatever the text, reading ends in a value or an error with a
// place.
#include "proto/json_read.h"
#include "proto/messages.h"
#include "tests/fuzz/target.h"

namespace tests::fuzz {

std::vector<std::string> seeds() {
  return {R"({"id":"alps","title":"Alps","crs":"EPSG:32632","resolution":[0.001,0.001],"origin":[5e5,5e6],)"
          R"("duplicates":"mean","vertices":[[1,2,3],[4.5,-6e2,7],[8,9,1e-3]]})",
          R"({"crs":"EPSG:4326","ops":[{"op":"insert","x":7.1,"y":45.9,"z":2310},{"op":"remove","id":3},)"
          R"({"op":"move","id":4,"x":1,"y":2},{"op":"set-z","id":5,"z":-7.25}]})",
          R"({"crs":"EPSG:3857","voids":"fill","positions":[[1,2],[3.5,4],[-1e5,0]]})",
          R"({"inputs":{"tin":"alps","tolerance":2.5,"maxVertices":1000,"as":"alps-5m"}})",
          R"({"a":"\u00e9\ud83d\ude00\n\"\\","b":[true,false,null,{"c":[[[[1]]]]}],"d":-0.0,"e":1e300,)"
          R"("f":18446744073709551615,"g":-9223372036854775808})",
          std::string(70, '[') + std::string(70, ']'),
          R"({"a":1,"a":2})",
          "\"\xc3\xa9\xed\xa0\x80\""};
}

namespace {

using proto::Value;

/// Asks each value all that can be asked of it. Returns how many there are.
std::size_t walk(const Value& value, std::size_t depth) {
  TIN_CHECK(depth <= proto::kMaxJsonDepth);
  std::size_t count = 1;
  const std::string pointer = value.pointer();
  TIN_CHECK(pointer.empty() || pointer.front() == '/');
  const auto number = value.number();
  if (number) TIN_CHECK(*number - *number == 0);
  const auto integer = value.integer(-1000, 1000);
  if (integer) TIN_CHECK(*integer >= -1000 && *integer <= 1000);
  const auto string = value.string(100);
  if (string) TIN_CHECK(string->size() <= 100);
  static_cast<void>(value.boolean());
  if (const auto object = value.any_object()) {
    for (const char* name : {"a", "b", "ops", "inputs", "vertices", "positions"}) {
      if (const auto member = object->find(name)) count += walk(*member, depth + 1);
    }
  }
  if (const auto array = value.array(1000)) {
    for (const Value item : *array) count += walk(item, depth + 1);
  }
  return count;
}

}  // namespace
}  // namespace tests::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes = tests::fuzz::text(data, size);
  const auto document = proto::Document::parse(bytes);
  if (document) TIN_CHECK(tests::fuzz::walk(document->root(), 0) > 0);
  const auto created = proto::read_create_tin(bytes, 100);
  const auto edits = proto::read_edit_request(bytes, {100, 3, 100});
  const auto elevations = proto::read_elevation_request(bytes, 100);
  if (!document) TIN_CHECK(!created && !edits && !elevations);
  if (edits) TIN_CHECK(edits->ops.size() <= 100);
  if (elevations) TIN_CHECK(elevations->positions.size() <= 100);
  return 0;
}
