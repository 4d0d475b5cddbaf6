// The simplify process: works on a version while edits go on, and lands as one revision or as a new TIN.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "server/app/catalogue.h"
#include "tin/simplify/simplify.h"

namespace server::app {

struct SimplifyRequest {
  std::shared_ptr<Tin> tin;
  tin::simplify::Options options;
  std::optional<std::string> as;  // id of the TIN to make; nothing: the TIN itself gets a new revision
};

struct Simplified {
  tin::simplify::Report report;
  std::shared_ptr<Tin> tin;    // the one that holds the result
  std::uint64_t revision = 0;  // of it
  double seconds = 0;
};

/// Errors: as simplify::simplify, Catalogue::create and Tin::remove_vertices; a cancelled or failed job
/// changes nothing.
tin::base::Result<Simplified> simplify_tin(Catalogue& catalogue, const SimplifyRequest& request,
                                           tin::base::Progress& progress);

}  // namespace server::app
