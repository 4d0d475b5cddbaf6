#include "tin/simplify/patch.h"

#include "tin/base/check.h"
#include "tin/delaunay/bulk.h"
#include "tin/delaunay/hilbert_sort.h"
#include "tin/delaunay/walk.h"

namespace tin::simplify {

using exact::Point;
using mesh::TriangleSlot;
using mesh::VertexSlot;

Patch::Patch(const Samples& samples, std::span<const Pin> frozen, std::span<const Pin> owned,
             unsigned threads)
    : samples_(&samples), owner_{static_cast<std::uint32_t>(frozen.size()) + 1} {
  const std::size_t count = frozen.size() + owned.size();
  // A few insertions must not double the arrays.
  const std::size_t room = count + count / 32 + 64;
  sites_.reserve(room);
  flags_.reserve(room);
  mesh_.reserve(room);
  sites_.resize(count + 1);
  sites_[0] = {};
  flags_.resize(count + 1);
  if (count == 0) return;
  mesh_.begin_bulk(count);
  std::uint32_t slot = 0;
  std::vector<Point> points;
  for (const auto pins : {frozen, owned}) {
    points.clear();
    for (const Pin& pin : pins) points.push_back(samples.position(pin.sample));
    for (const delaunay::OnCurve& next : delaunay::hilbert_sorted(points, threads)) {
      const Pin& pin = pins[next.index];
      mesh_.set_point(VertexSlot(++slot), points[next.index]);
      sites_[slot] = samples.site(pin.sample);
      sites_[slot].z = pin.z;
      flags_[slot] = static_cast<std::uint8_t>((pin.fixed ? kFixed : 0) | (pin.settled ? kSettled : 0));
    }
  }
  TIN_CHECK(delaunay::build_bulk(mesh_, threads, nullptr));
}

void Patch::put(VertexSlot v, const Site& site) {
  if (v.value() >= sites_.size()) {
    sites_.resize(v.value() + 1);
    flags_.resize(v.value() + 1);
  }
  sites_[v.value()] = site;
  flags_[v.value()] = 0;
}

void Patch::note_vertices() {
  if (Footprint* const footprint = samples_->footprint()) footprint->add_vertices(not_noted_);
  not_noted_ = 0;
}

std::optional<VertexSlot> Patch::insert(const Site& site, TriangleSlot near) {
  if (!carve(site, near)) return std::nullopt;
  return fill(site);
}

bool Patch::carve(const Site& site, TriangleSlot near) {
  const auto stop = delaunay::walk(mesh_, site.at, near, delaunay::Everywhere{});
  VertexSlot there;
  if (delaunay::at_vertex(stop, there) || stop.kind != delaunay::Stop::Kind::kInside) return false;
  beside_ = stop.b.vertex;
  return cavity_.carve(mesh_, site.at, stop, owner_);
}

VertexSlot Patch::fill(const Site& site) {
  const VertexSlot v = mesh_.add_vertex(site.at, beside_);
  const TriangleSlot extra = mesh_.claim_triangle(cavity_.some_triangle());
  cavity_.fill(mesh_, v, extra, mesh_.claim_triangle(extra));
  put(v, site);
  if (++not_noted_ >= kNotedLate) note_vertices();
  fresh_.assign(cavity_.star().begin(), cavity_.star().end());
  for (const TriangleSlot t : fresh_) {
    const auto& corners = mesh_.triangle(t).vertices;
    unsettle(corners[1]);
  }
  return v;
}

bool Patch::is_removable(VertexSlot v) const {
  return !is_fixed(v) && has_star(v);
}

bool Patch::has_star(VertexSlot v) const {
  if (!owns(v) || mesh_.dimension() < 2) return false;
  if (owner_.first == 1) return true;
  const TriangleSlot first = mesh_.triangle_at(v);
  TriangleSlot t = first;
  do {
    const int i = mesh_.index_of(t, v);
    if (!owns(mesh_.vertex(t, mesh::next3(i)))) return false;
    t = mesh_.twin(t, mesh::next3(i)).triangle();
  } while (t != first);
  return true;
}

bool Patch::remove(VertexSlot v) {
  if (!remover_.remove(mesh_, v, fresh_)) return false;
  if (--not_noted_ <= -kNotedLate) note_vertices();
  for (const TriangleSlot t : fresh_) {
    for (const VertexSlot corner : mesh_.triangle(t).vertices) unsettle(corner);
  }
  return true;
}

void Patch::set_height(VertexSlot v, double z) {
  sites_[v.value()].z = z;
  fresh_.clear();
  const TriangleSlot first = mesh_.triangle_at(v);
  TriangleSlot t = first;
  do {
    fresh_.push_back(t);
    for (const VertexSlot corner : mesh_.triangle(t).vertices) unsettle(corner);
    t = mesh_.twin(t, mesh::next3(mesh_.index_of(t, v))).triangle();
  } while (t != first);
}

void Patch::collect(std::vector<Pin>& out) const {
  out.reserve(out.size() + owned_count());
  for (std::uint32_t i = owner_.first; i < mesh_.vertex_slots(); ++i) {
    const VertexSlot v(i);
    if (mesh_.is_alive(v)) out.push_back({site(v).z, site(v).sample, is_fixed(v), is_settled(v)});
  }
}

}  // namespace tin::simplify
