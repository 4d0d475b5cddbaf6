// The decoders of journal records and checkpoints: what they accept, they write again as the same bytes.
// Every input is tried as it is, and with a checksum that fits, so that what stands behind the checksum is
// reached.
#include "tests/fuzz/target.h"
#include "tests/tin/codec/resummed.h"
#include "tin/codec/change.h"
#include "tin/codec/checkpoint.h"

namespace tests::fuzz {

using namespace tin;

std::vector<std::string> seeds() {
  terrain::Change change;
  change.steps.push_back({terrain::VertexId{1}, std::nullopt, terrain::Placement{{3, -4}, 2.5}});
  change.steps.push_back(
      {terrain::VertexId{2}, terrain::Placement{{0, 7}, 1}, terrain::Placement{{9, 9}, -1}});
  change.steps.push_back(
      {terrain::VertexId{7}, terrain::Placement{{536870911, -536870912}, 1e300}, std::nullopt});
  terrain::Change undo = change;
  undo.cause = terrain::Cause::kUndo;
  codec::Checkpoint points;
  points.revision = 7;
  points.digest = "0123456789abcdef";
  points.next_id = terrain::VertexId{4};
  points.frame.crs = "EPSG:32632";
  points.frame.vertical_unit = "metre";
  for (std::uint32_t id = 1; id <= 3; ++id) {
    points.vertices.push_back({terrain::VertexId{id}, {static_cast<std::int32_t>(id), 5}, 0.5 * id});
  }
  codec::Checkpoint raster = points;
  raster.grid = std::make_shared<terrain::SourceGrid>(
      terrain::SourceGrid{3, 2, -10, 10, 10, -10, {5e5, 1, 0, 5e6, 0, -1}, -9999.0, "Int16", {0b101101}});
  terrain::Amendments::Parts parts;
  parts.kind = terrain::SourceKind::kPoints;
  parts.thinned = true;
  parts.next_deed = 6;
  parts.deeds = {{4, 0x0123456789abcdef, 1, true}, {5, 7, 0, false}};
  parts.touches = {{{1, 5}, 4}, {{1, 6}, 0}};
  parts.areas = {{{exact::Point{0, 9}, exact::Point{1, 5}, exact::Point{9, 5}}, 3}};
  parts.own = {{{{2, 6}, 1.5}, 0}, {{{2, 6}, 2.5}, 5}};
  codec::Checkpoint edited = points;
  edited.amendments = terrain::Amendments(parts);
  codec::Checkpoint open;
  open.open_resolution = {0.001, 0.001};
  return {codec::encode_change(change), codec::encode_change(undo), codec::encode_change({}), codec::encode_checkpoint(points),
          codec::encode_checkpoint(raster), codec::encode_checkpoint(edited), codec::encode_checkpoint(open)};
}

namespace {

void decode(const std::string& bytes) {
  if (const auto change = codec::decode_change(bytes)) TIN_CHECK(codec::encode_change(*change) == bytes);
  if (const auto checkpoint = codec::decode_checkpoint(bytes)) {
    const std::string again = codec::encode_checkpoint(*checkpoint);
    // What is read of the second version is written as the third.
    TIN_CHECK(again == bytes || (bytes[4] == 2 && codec::encode_checkpoint(*codec::decode_checkpoint(again)) == again));
  }
}

}  // namespace
}  // namespace tests::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string bytes(tests::fuzz::text(data, size));
  tests::fuzz::decode(bytes);
  tests::fuzz::decode(tin::codec::testing::resummed(bytes));
  return 0;
}
