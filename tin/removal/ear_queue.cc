#include "tin/removal/ear_queue.h"

#include <algorithm>

#include "tin/exact/predicates.h"

namespace tin::removal {

using exact::orientation;
using mesh::HalfEdge;
using mesh::kInfinite;
using mesh::Mesh;
using mesh::TriangleSlot;
using mesh::VertexSlot;

std::span<const Ear> EarQueue::fill(const Mesh& mesh, VertexSlot v) {
  make_ring(mesh, v);
  if (leaves_a_line(mesh)) return {};
  use_heap_ = ring_.size() > kLinearLimit;
  if (left_ > 3) {
    for (std::uint32_t i = 0; i < ring_.size(); ++i) renew_ear(i);
  }
  while (left_ > 3) {
    const std::uint32_t node = take_smallest();
    if (node == kNoEar) break;
    const std::uint32_t previous = ring_[node].previous, next = ring_[node].next;
    cut(node);
    renew_ear(previous);
    renew_ear(next);
  }
  if (left_ > 3) close_hull();
  cut(ring_[some_node_].next);
  return ears_;
}

void EarQueue::make_ring(const Mesh& mesh, VertexSlot v) {
  mesh.link(v, link_);
  removed_ = mesh.point(v);
  const auto k = static_cast<std::uint32_t>(link_.size());
  ring_.resize(k);
  candidates_.clear();
  heap_.clear();
  ears_.clear();
  infinite_ = kNoEar;
  some_node_ = 0;
  left_ = k;
  for (std::uint32_t i = 0; i < k; ++i) {
    const VertexSlot q = mesh.origin(link_[i]);
    ring_[i] = {q, mesh.point(q), i == 0 ? k - 1 : i - 1, i + 1 == k ? 0 : i + 1, kNoEar};
    if (q == kInfinite) infinite_ = i;
  }
}

/// Makes the present ear at `node`, if its corners are finite and turn left.
void EarQueue::renew_ear(std::uint32_t node) {
  Node& middle = ring_[node];
  middle.ear = kNoEar;
  if (node == infinite_ || middle.previous == infinite_ || middle.next == infinite_) return;
  const exact::Point a = ring_[middle.previous].point, b = middle.point, c = ring_[middle.next].point;
  if (orientation(a, b, c) <= 0) return;
  middle.ear = static_cast<std::uint32_t>(candidates_.size());
  candidates_.push_back({exact::ear_power(a, b, c, removed_), node});
  if (!use_heap_) return;
  heap_.push_back(middle.ear);
  std::push_heap(heap_.begin(), heap_.end(), [this](std::uint32_t l, std::uint32_t r) {
    return exact::comes_before(candidates_[r].power, candidates_[l].power, removed_);
  });
}

std::uint32_t EarQueue::take_smallest() { return use_heap_ ? take_from_heap() : take_by_scan(); }

std::uint32_t EarQueue::take_by_scan() {
  std::uint32_t best = kNoEar;
  std::uint32_t node = some_node_;
  do {
    const std::uint32_t ear = ring_[node].ear;
    if (ear != kNoEar && (best == kNoEar || exact::comes_before(candidates_[ear].power, candidates_[best].power, removed_))) {
      best = ear;
    }
    node = ring_[node].next;
  } while (node != some_node_);
  return best == kNoEar ? kNoEar : candidates_[best].node;
}

std::uint32_t EarQueue::take_from_heap() {
  while (!heap_.empty()) {
    std::pop_heap(heap_.begin(), heap_.end(), [this](std::uint32_t l, std::uint32_t r) {
      return exact::comes_before(candidates_[r].power, candidates_[l].power, removed_);
    });
    const std::uint32_t ear = heap_.back();
    heap_.pop_back();
    const std::uint32_t node = candidates_[ear].node;
    if (ring_[node].ear == ear) return node;  // otherwise it was cut or renewed since
  }
  return kNoEar;
}

void EarQueue::cut(std::uint32_t node) {
  Node& middle = ring_[node];
  ears_.push_back({middle.previous, node, middle.next});
  ring_[middle.previous].next = middle.next;
  ring_[middle.next].previous = middle.previous;
  middle.ear = kNoEar;
  some_node_ = middle.previous;
  --left_;
}

/// No left turn is left on the finite chain: each of its edges lies on the new hull.
void EarQueue::close_hull() {
  TIN_CHECK(infinite_ != kNoEar);
  while (left_ > 3) cut(ring_[infinite_].next);
}

bool EarQueue::leaves_a_line(const Mesh& mesh) const {
  if (infinite_ == kNoEar || ring_.size() != mesh.vertex_count()) return false;
  std::uint32_t i = ring_[infinite_].next;
  const exact::Point first = ring_[i].point;
  const exact::Point second = ring_[ring_[i].next].point;
  while (i != infinite_) {
    if (orientation(first, second, ring_[i].point) != 0) return false;
    i = ring_[i].next;
  }
  return true;
}

bool EarQueue::remove(Mesh& mesh, VertexSlot v, std::vector<TriangleSlot>& fresh) {
  fresh.clear();
  if (fill(mesh, v).empty()) return false;
  outside_.resize(link_.size());
  for (std::size_t i = 0; i < link_.size(); ++i) outside_[i] = mesh.twin(link_[i]);
  for (std::size_t i = 0; i < ears_.size(); ++i) {
    const auto [previous, middle, next] = ears_[i];
    const TriangleSlot t = link_[i].triangle();  // k - 2 of the star's k slots are used again
    mesh.set_triangle(t, ring_[previous].vertex, ring_[middle].vertex, ring_[next].vertex);
    mesh.join(HalfEdge(t, 2), outside_[previous]);
    mesh.join(HalfEdge(t, 0), outside_[middle]);
    if (i + 1 == ears_.size()) mesh.join(HalfEdge(t, 1), outside_[next]);
    outside_[previous] = HalfEdge(t, 1);
    fresh.push_back(t);
  }
  mesh.release_triangle(link_[link_.size() - 2].triangle());
  mesh.release_triangle(link_[link_.size() - 1].triangle());
  mesh.release_vertex(v);
  return true;
}

}  // namespace tin::removal
