#include "tin/simplify/source_mesh.h"

#include <algorithm>

#include "tin/base/check.h"
#include "tin/delaunay/bulk.h"
#include "tin/delaunay/hilbert_sort.h"

namespace tin::simplify {

using exact::Point;
using mesh::TriangleSlot;
using mesh::VertexSlot;

namespace {

constexpr std::size_t kAtOnce = std::size_t{1} << 20;  // samples between two questions whether to go on

}  // namespace

std::shared_ptr<const SourceMesh> SourceMesh::of(const Samples& samples, unsigned threads,
                                                 const base::Progress* progress) {
  const std::shared_ptr<SourceMesh> made(new SourceMesh);
  return made->build(samples, threads, progress) ? made : nullptr;
}

/// False when cancelled.
bool SourceMesh::build(const Samples& samples, unsigned threads, const base::Progress* progress) {
  base::Progress silent(progress);
  slots_.assign(samples.end(), mesh::kNone);
  std::vector<Site> sites;
  const std::size_t end = samples.end();
  for (std::size_t begin = 0; begin < end && !silent.cancelled(); begin += kAtOnce) {
    samples.sites(static_cast<SampleIndex>(begin), static_cast<SampleIndex>(std::min(end, begin + kAtOnce)),
                  sites);
  }
  if (silent.cancelled()) return false;
  std::vector<Point> points;
  points.reserve(sites.size());
  for (const Site& site : sites) points.push_back(site.at);
  const auto along_curve = delaunay::hilbert_sorted(points, threads);
  if (silent.cancelled()) return false;
  z_.resize(sites.size() + 1);
  samples_of_.resize(sites.size() + 1);
  mesh_.begin_bulk(sites.size());
  std::uint32_t slot = 0;
  for (const delaunay::OnCurve& next : along_curve) {
    mesh_.set_point(VertexSlot(++slot), points[next.index]);
    z_[slot] = sites[next.index].z;
    samples_of_[slot] = sites[next.index].sample;
    slots_[samples_of_[slot]] = slot;
    if (slot % kAtOnce == 0 && silent.cancelled()) return false;
  }
  std::vector<Site>().swap(sites);
  std::vector<Point>().swap(points);
  if (!delaunay::build_bulk(mesh_, threads, &silent)) return false;
  TIN_CHECK(mesh_.dimension() == 2);
  return true;
}

SourceMesh::Exit SourceMesh::leave(VertexSlot from, Point a, Point b) const {
  const Point here = mesh_.point(from);
  const auto is_ahead = [&](Point p) {
    return (std::int64_t{b.x} - a.x) * (std::int64_t{p.x} - here.x) +
               (std::int64_t{b.y} - a.y) * (std::int64_t{p.y} - here.y) >
           0;
  };
  const TriangleSlot first = mesh_.triangle_at(from);
  TriangleSlot t = first;
  do {
    const int i = mesh_.index_of(t, from);
    const VertexSlot p = mesh_.vertex(t, mesh::next3(i)), q = mesh_.vertex(t, mesh::prev3(i));
    if (p != mesh::kInfinite) {
      const std::int64_t side = exact::orientation(a, b, mesh_.point(p));
      if (side == 0 && is_ahead(mesh_.point(p))) return {p, {}};
      // From the right of the segment counter-clockwise to its left: that is over what is ahead.
      if (side < 0 && q != mesh::kInfinite && exact::orientation(a, b, mesh_.point(q)) > 0)
        return {std::nullopt, mesh_.twin(t, i)};
    }
    t = mesh_.twin(t, mesh::next3(i)).triangle();
  } while (t != first);
  TIN_CHECK(false && "a segment between two vertices leaves the first of them");
  return {};
}

}  // namespace tin::simplify
