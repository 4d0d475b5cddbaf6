#include "tin/removal/star.h"

namespace tin::removal {

using mesh::HalfEdge;
using mesh::kInfinite;
using mesh::Mesh;
using mesh::TriangleSlot;
using mesh::VertexSlot;

void Star::enlarge() {
  const std::size_t room = link_.empty() ? 64 : 2 * link_.size();
  link_.resize(room);
  clockwise_.resize(room);
  outside_.resize(room);
  vertices_.resize(room);
  at_.resize(room);
}

void Star::gather(const Mesh& mesh, VertexSlot v) {
  walk_around(mesh, v);
  removed_ = v;
  vertices_in_mesh_ = mesh.vertex_count();
  infinite_ = kNowhere;
  const exact::Point origin = mesh.point(v);
  for (std::uint32_t i = 0; i < degree_; ++i) {
    const mesh::Triangle& t = mesh.triangle(link_[i].triangle());
    const int at = link_[i].index();
    const VertexSlot q = t.vertices[static_cast<std::size_t>(mesh::next3(at))];
    if (q == kInfinite) [[unlikely]] infinite_ = i;
    outside_[i] = t.neighbours[static_cast<std::size_t>(at)];
    vertices_[i] = q;
    at_[i] = exact::lift(mesh.point(q), origin);
  }
}

/// Finds the link's edges in both directions at a time: each step waits for memory, but the two do not wait
/// for each other. What will be asked of the neighbourhood next, or written there, is fetched meanwhile.
void Star::walk_around(const Mesh& mesh, VertexSlot v) {
  const auto fetch = [&mesh](HalfEdge e) {
    mesh.prefetch(mesh.origin(e));
    mesh.prefetch(mesh.twin(e).triangle());
  };
  mesh.prefetch_around(TriangleSlot(2 * v.value()));
  const TriangleSlot first = mesh.triangle_at(v);
  HalfEdge ahead(first, mesh.index_of(first, v)), behind = ahead;
  std::uint32_t counter_clockwise = 0, clockwise = 0;
  for (;;) {
    if (counter_clockwise == link_.size()) [[unlikely]] enlarge();
    link_[counter_clockwise++] = ahead;
    fetch(ahead);
    // Over the edge that ends at v on the one side, and begins there on the other.
    const HalfEdge next = mesh.twin(ahead.triangle(), mesh::next3(ahead.index()));
    const HalfEdge last = mesh.twin(behind.triangle(), mesh::prev3(behind.index()));
    if (next.triangle() == behind.triangle()) break;
    ahead = HalfEdge(next.triangle(), mesh::next3(next.index()));
    if (last.triangle() == ahead.triangle()) {
      if (counter_clockwise == link_.size()) [[unlikely]] enlarge();
      link_[counter_clockwise++] = ahead;
      fetch(ahead);
      break;
    }
    behind = HalfEdge(last.triangle(), mesh::prev3(last.index()));
    clockwise_[clockwise++] = behind;
    fetch(behind);
  }
  degree_ = counter_clockwise + clockwise;
  while (link_.size() < degree_) enlarge();
  for (std::uint32_t i = 0; i < clockwise; ++i) link_[degree_ - 1 - i] = clockwise_[i];
}

bool Star::leaves_a_line() const {
  if (!is_on_hull() || degree() != vertices_in_mesh_) return false;
  const std::uint32_t first = infinite_ == 0 ? 1 : 0;
  const std::uint32_t second = infinite_ == first + 1 ? first + 2 : first + 1;
  for (std::uint32_t i = second + 1; i < degree(); ++i) {
    if (i != infinite_ && exact::orientation(at_[first], at_[second], at_[i]) != 0) return false;
  }
  return true;
}

/// The infinite vertex lies straight up: with it in the determinant only the turn of the other three is left.
/// A collinear three a, b, c, in the order of the link behind the infinite vertex, have b between a and c,
/// and b stays on the hull: the line gives way outwards, as if it turned right. (Moving the infinite vertex a
/// little beyond infinity, seen from the removed one, does this for all lines at once.)
int Star::hull_sign(std::uint32_t a, std::uint32_t b, std::uint32_t c) const {
  const std::int64_t turn = exact::orientation(at_[a], at_[b], at_[c]);
  if (turn != 0) return turn > 0 ? 1 : -1;
  const auto rank = [this](std::uint32_t i) {
    return i > infinite_ ? i - infinite_ : i + degree() - infinite_;
  };
  const bool ascending = (rank(a) < rank(b)) == ((rank(b) < rank(c)) == (rank(a) < rank(c)));
  return ascending ? -1 : 1;
}

bool Star::in_conflict_on_hull(std::uint32_t i, std::uint32_t j, std::uint32_t k, std::uint32_t l) const {
  if (i == infinite_) return hull_sign(l, j, k) > 0;
  if (j == infinite_) return hull_sign(i, l, k) > 0;
  if (k == infinite_) return hull_sign(i, j, l) > 0;
  if (l == infinite_) return hull_sign(i, j, k) < 0;
  return exact::lifted_sign(at_[i], at_[j], at_[k], at_[l]) > 0;
}

void Star::refill(Mesh& mesh, std::span<const Ear> ears, std::vector<TriangleSlot>& fresh) {
  TIN_DCHECK(ears.size() + 2 == degree_);
  fresh.resize(ears.size());
  const auto sew = [&](HalfEdge inside, HalfEdge outside) {
    mesh.set_twin(outside, inside);
    return outside;
  };
  for (std::size_t i = 0; i < ears.size(); ++i) {
    const auto [previous, middle, next] = ears[i];
    const TriangleSlot t = link_[i].triangle();  // k - 2 of the star's k slots are used again
    const HalfEdge open(t, 1);
    mesh.write_triangle(
        t, {{vertices_[previous], vertices_[middle], vertices_[next]},
            {sew(HalfEdge(t, 0), outside_[middle]), HalfEdge(), sew(HalfEdge(t, 2), outside_[previous])}});
    mesh.set_triangle_at(vertices_[middle], t);
    outside_[previous] = open;
    fresh[i] = t;
  }
  const auto [previous, middle, next] = ears.back();
  const TriangleSlot last = fresh.back();
  mesh.join(HalfEdge(last, 1), outside_[next]);
  mesh.set_triangle_at(vertices_[previous], last);
  mesh.set_triangle_at(vertices_[next], last);
  mesh.release_triangle(link_[degree_ - 2].triangle());
  mesh.release_triangle(link_[degree_ - 1].triangle());
  mesh.release_vertex(removed_);
}

}  // namespace tin::removal
