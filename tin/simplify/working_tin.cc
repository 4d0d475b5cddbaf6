#include "tin/simplify/working_tin.h"

#include "tin/base/check.h"

namespace tin::simplify {

using mesh::VertexSlot;

WorkingTin::WorkingTin(const Samples& samples, std::span<const SampleIndex> corners)
    : samples_(&samples), corner_count_(corners.size()) {
  for (const SampleIndex corner : corners) {
    const Site at = samples.site(corner);
    const auto [v, fresh] = triangulation_.insert(at.at);
    TIN_CHECK(fresh && v.value() <= corner_count_);
    put(v, at);
  }
}

void WorkingTin::put(VertexSlot v, const Site& site) {
  if (v.value() >= sites_.size()) sites_.resize(v.value() + 1);
  sites_[v.value()] = site;
}

VertexSlot WorkingTin::insert(SampleIndex sample, VertexSlot near) {
  const Site at = samples_->site(sample);
  const auto [v, fresh] = triangulation_.insert_near(at.at, near);
  TIN_CHECK(fresh);
  put(v, at);
  return v;
}

void WorkingTin::remove(VertexSlot v) {
  TIN_DCHECK(!is_corner(v));
  triangulation_.remove(v);
}

}  // namespace tin::simplify
