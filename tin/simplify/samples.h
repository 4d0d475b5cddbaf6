// The samples that a TIN must stay close to, and the question that simplification asks all the time: how far
// are those over this triangle from it?
#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "tin/base/progress.h"
#include "tin/exact/point.h"
#include "tin/terrain/terrain.h"

namespace tin::simplify {

/// Names a sample: an order that depends on the set of samples only, so that ties decided by it are
/// reproducible.
using SampleIndex = std::uint32_t;

/// A sample with all that scans want to know of it when it is a triangle's corner.
struct Site {
  exact::Point at;
  std::int32_t column = -1, row = -1;  // cell of the raster that it is the centre of; -1: none
  double z = 0;
  SampleIndex sample = 0;
};

/// What the samples over a triangle say.
struct Scan {
  double error = 0;        // largest vertical distance, rounded
  SampleIndex sample = 0;  // the one it belongs to, the first of equals; one over the tolerance if any is
  bool over = false;       // whether a sample is over the tolerance: exact
};

/// How much a scan should find out.
enum class Depth {
  kWorst,      // the worst sample
  kFirstOver,  // may stop once a sample is over the tolerance: `error` and `sample` are then any such
};

class Samples {
 public:
  virtual ~Samples() = default;

  /// Looks at all samples in the closed triangle. Requires: corners not collinear, tolerance finite and >= 0.
  /// A scan that is cancelled ends early with an answer of no worth: ask before using it.
  virtual Scan scan(const Site& a, const Site& b, const Site& c, double tolerance, Depth depth) const = 0;

  virtual Site site(SampleIndex sample) const = 0;
  /// The sample at `p`. Requires: there is one.
  virtual SampleIndex find(exact::Point p) const = 0;
};

/// The samples of a terrain: on its raster where most of its vertices are, else as scattered points. Nothing
/// when cancelled. Borrows `source` and `progress`.
std::unique_ptr<Samples> make_samples(const terrain::Terrain& source, base::Progress* progress);

}  // namespace tin::simplify
