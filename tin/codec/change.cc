#include "tin/codec/change.h"

#include <cstdint>

#include "tin/base/check.h"
#include "tin/codec/bytes_internal.h"

namespace tin::codec {
namespace {

constexpr std::string_view kMagic = "TNSJ";
constexpr std::uint16_t kVersion = 3;
constexpr std::uint16_t kEditVersion = 1;       // edits, which are nearly all, need no cause
constexpr std::uint16_t kWithoutUndoVersion = 2;  // the causes that there were before an edit's undoing was one
constexpr std::uint8_t kBefore = 1;
constexpr std::uint8_t kAfter = 2;
constexpr std::size_t kSmallestStep = 1 + 1 + (1 + 1 + 8);  // parts, id, one placement

// Ids differ modulo 2^64: as a signed number the short way round, without overflow.
std::int64_t difference(std::uint64_t to, std::uint64_t from) {
  return static_cast<std::int64_t>(to - from);
}

void write_step(Writer& out, const terrain::Step& step, std::uint64_t previous_id) {
  TIN_CHECK(step.id.value() != 0 && (step.before || step.after));
  out.u8(static_cast<std::uint8_t>((step.before ? kBefore : 0) | (step.after ? kAfter : 0)));
  out.zigzag(difference(step.id.value(), previous_id));
  if (step.before) out.placement(*step.before);
  if (step.after) out.placement(*step.after);
}

terrain::Step read_step(Reader& in, std::uint64_t previous_id) {
  terrain::Step step;
  const std::uint8_t parts = in.u8();
  in.require(parts >= 1 && parts <= (kBefore | kAfter), "a step of an unknown kind");
  step.id = terrain::VertexId(previous_id + static_cast<std::uint64_t>(in.zigzag()));
  in.require(step.id.value() != 0, "a vertex id is 0");
  if ((parts & kBefore) != 0) step.before = in.placement();
  if ((parts & kAfter) != 0) step.after = in.placement();
  return step;
}

/// The oldest that says it.
std::uint16_t version_for(terrain::Cause cause) {
  switch (cause) {
    case terrain::Cause::kEdit:
      return kEditVersion;
    case terrain::Cause::kRevert:
    case terrain::Cause::kSimplification:
      return kWithoutUndoVersion;
    case terrain::Cause::kUndo:
      break;
  }
  return kVersion;
}

terrain::Cause read_cause(Reader& in) {
  const std::uint8_t cause = in.u8();
  const bool known = cause <= static_cast<std::uint8_t>(terrain::Cause::kUndo) &&
                     version_for(static_cast<terrain::Cause>(cause)) == in.version();
  in.require(known, "an unknown cause of a change");
  return known ? static_cast<terrain::Cause>(cause) : terrain::Cause::kEdit;
}

}  // namespace

std::string encode_change(const terrain::Change& change) {
  Writer out(kMagic, version_for(change.cause));
  out.reserve(32 + 2 * kSmallestStep * change.steps.size());
  if (change.cause != terrain::Cause::kEdit) out.u8(static_cast<std::uint8_t>(change.cause));
  out.varint(change.steps.size());
  std::uint64_t previous_id = 0;
  for (const terrain::Step& step : change.steps) {
    write_step(out, step, previous_id);
    previous_id = step.id.value();
  }
  return out.finish();
}

base::Result<terrain::Change> decode_change(std::string_view bytes) {
  Reader in(bytes, kMagic, kVersion, "journal record");
  terrain::Change change;
  if (in.version() != kEditVersion) change.cause = read_cause(in);
  const std::size_t count = in.count(kSmallestStep);
  change.steps.reserve(count);
  std::uint64_t previous_id = 0;
  for (std::size_t i = 0; i < count && in.ok(); ++i) {
    change.steps.push_back(read_step(in, previous_id));
    previous_id = change.steps.back().id.value();
  }
  in.finish();
  if (!in.ok()) return in.error();
  return change;
}

}  // namespace tin::codec
