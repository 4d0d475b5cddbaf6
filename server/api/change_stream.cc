#include "server/api/change_stream.h"

#include <utility>

#include "server/api/history.h"

namespace server::api {
namespace {

constexpr std::chrono::seconds kHeartbeat{15};
constexpr std::size_t kAtOnce = 100;  // revisions

}  // namespace

ChangeStream::ChangeStream(app::Catalogue& catalogue, std::shared_ptr<app::Tin> tin, std::uint64_t since,
                           Slots& listeners)
    : catalogue_(catalogue),
      tin_(std::move(tin)),
      sent_(since),
      listeners_(listeners),
      last_sign_(Clock::now()) {}

ChangeStream::~ChangeStream() {
  listeners_.release();
}

bool ChangeStream::next(std::string& piece) {
  if (ended_) return false;
  if (!std::exchange(begun_, true)) {
    piece = ": changes of " + tin_->id() + "\n\n";  // so that the client sees its stream begin
    return true;
  }
  const auto present = catalogue_.find(tin_->id());
  if (!present || *present != tin_) {
    end(piece, "deleted", "the TIN is gone");
  } else if (tin_->revision() > sent_) {
    if (!append_changes(piece)) end(piece, "gap", "what came next is no longer kept: fetch the TIN anew");
  } else if (Clock::now() - last_sign_ >= kHeartbeat) {
    piece = ": still here\n\n";
  }
  if (!piece.empty()) last_sign_ = Clock::now();
  return true;
}

/// False when the next revision is no longer there.
bool ChangeStream::append_changes(std::string& piece) {
  const auto page =
      app::read_revisions(catalogue_.store(), tin_->id(), {.first = sent_ + 1, .most_rows = kAtOnce});
  if (!page) return true;  // deleted at this moment, or the store's trouble: the next call will see
  if (page->revisions.empty() || page->revisions.front().revision != sent_ + 1) return false;
  const auto frame =
      tin_->read([](const tin::terrain::Terrain& terrain, std::uint64_t) { return terrain.frame(); });
  for (const app::RevisionSummary& revision : page->revisions) {
    piece += "id: " + std::to_string(revision.revision) + "\nevent: change\ndata: ";
    piece += proto::revision_json(revision_document(revision, frame)) + "\n\n";
    sent_ = revision.revision;
  }
  return true;
}

void ChangeStream::end(std::string& piece, std::string_view event, std::string_view why) {
  piece.append("event: ").append(event).append("\ndata: ").append(why).append("\n\n");
  ended_ = true;
}

}  // namespace server::api
