// One write to a TIN on its way: what is to be done, under what terms, and what came of it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "server/app/world_edit.h"
#include "server/store/store.h"
#include "tin/base/result.h"
#include "tin/terrain/terrain.h"

namespace server::app {

struct Edited {
  std::uint64_t revision = 0;
  std::vector<VertexId> ids;  // one per edit; of an edit of an area as many as it removed
  std::vector<AreaResult> areas = {};
  friend bool operator==(const Edited&, const Edited&) = default;
};

/// What a client may send with a request, so that it has one effect however often it arrives.
struct RequestKey {
  std::string key;
  std::string request;  // a fingerprint of the request
};

/// What an edit is bound to, and what is remembered with it.
struct Terms {
  std::span<const std::uint64_t> expected =
      {};  // the present revision must be one of these, if any are given
  store::RevisionInfo info = {};
  std::optional<RequestKey> key = std::nullopt;
  std::size_t most_within = SIZE_MAX;  // vertices that edits of areas may remove
};

/// See WriteQueue. Exactly one of `apply`, `first_vertices`, `prepared` and `instead` is set.
struct Write {
  explicit Write(const Terms& t) : terms(t) {}

  const Terms& terms;
  std::size_t weight = 1;  // steps, about
  bool alone = false;

  /// Changes the terrain, or leaves it as it was and says why. May fill `areas`.
  std::function<tin::base::Result<tin::terrain::Terrain::Applied>(tin::terrain::Terrain&)> apply;
  std::vector<AreaResult> areas;
  /// Edits that may come to an open frame.
  std::span<const WorldEdit> first_vertices;
  /// A terrain that was made of that of revision `prepared_from` by `change`, to take its place.
  std::shared_ptr<tin::terrain::Terrain> prepared;
  std::uint64_t prepared_from = 0;
  tin::terrain::Change change;
  /// What is done in the writer's turn and is no revision.
  std::function<tin::base::Result<void>()> instead;

  std::optional<tin::base::Result<Edited>> outcome;
  bool outdated = false;  // `prepared` came too late
};

/// The bytes under which an answer is kept, and back. Errors: kStorage.
std::string encode_edited(const Edited& edited);
tin::base::Result<Edited> decode_edited(std::string_view bytes);

}  // namespace server::app
