// What revisions did, read from the journal.
#pragma once

#include <cstdint>
#include <vector>

#include "server/store/store.h"
#include "tin/base/result.h"
#include "tin/terrain/terrain.h"

namespace server::app {

struct RevisionSummary {
  std::uint64_t revision = 0;
  store::RevisionInfo info;
  std::uint64_t inserted = 0, removed = 0, changed = 0;  // vertices
  tin::terrain::Box bounds;                              // of these, before and after
};

/// Vertices count by what became of them: one that came and went within the revision does not. Errors:
/// kMalformed, kUnsupported.
tin::base::Result<RevisionSummary> summarise(const store::JournalRow& row);

struct RevisionPage {
  std::vector<RevisionSummary> revisions;
  std::uint64_t present = 0;  // the TIN's revision
  std::uint64_t oldest = 0;   // that is kept; 0: none is
};

/// Part of a TIN's journal; ends early where records are large. Errors: as Store::read_journal and
/// summarise().
tin::base::Result<RevisionPage> read_revisions(store::Store& store, std::string_view tin,
                                               store::JournalRange range);

}  // namespace server::app
