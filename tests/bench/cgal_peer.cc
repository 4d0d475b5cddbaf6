#include "tests/bench/cgal_peer.h"

#ifdef TINSMITH_BENCH_CGAL

#include <CGAL/Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_hierarchy_2.h>

#include <vector>

namespace bench {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Plain = CGAL::Delaunay_triangulation_2<Kernel>;
using HierarchyVertex = CGAL::Triangulation_hierarchy_vertex_base_2<CGAL::Triangulation_vertex_base_2<Kernel>>;
using HierarchyData = CGAL::Triangulation_data_structure_2<HierarchyVertex>;
using Hierarchical = CGAL::Triangulation_hierarchy_2<CGAL::Delaunay_triangulation_2<Kernel, HierarchyData>>;

Kernel::Point_2 to_cgal(tin::exact::Point p) { return {static_cast<double>(p.x), static_cast<double>(p.y)}; }

template <class T>
class Peer : public CgalPeer {
 public:
  void build(std::span<const tin::exact::Point> points) override {
    std::vector<Kernel::Point_2> copy;
    copy.reserve(points.size());
    for (const auto p : points) copy.push_back(to_cgal(p));
    triangulation_.insert(copy.begin(), copy.end());
  }
  void insert(std::span<const tin::exact::Point> points) override {
    for (const auto p : points) triangulation_.insert(to_cgal(p));
  }
  void remember(std::span<const tin::exact::Point> points) override {
    handles_.clear();
    typename T::Face_handle near;
    for (const auto p : points) {
      near = triangulation_.locate(to_cgal(p), near);
      for (int i = 0; i < 3; ++i) {
        if (!triangulation_.is_infinite(near->vertex(i)) && near->vertex(i)->point() == to_cgal(p)) handles_.push_back(near->vertex(i));
      }
    }
  }
  void remove(std::span<const std::uint32_t> order) override {
    for (const std::uint32_t i : order) triangulation_.remove(handles_[i]);
  }
  std::size_t locate(std::span<const tin::exact::Point> points) override {
    std::size_t inside = 0;
    for (const auto p : points) inside += triangulation_.is_infinite(triangulation_.locate(to_cgal(p))) ? 0 : 1;
    return inside;
  }
  std::size_t vertices() const override { return triangulation_.number_of_vertices(); }

 private:
  T triangulation_;
  std::vector<typename T::Vertex_handle> handles_;
};

}  // namespace

std::unique_ptr<CgalPeer> make_cgal_peer(bool with_hierarchy) {
  if (with_hierarchy) return std::make_unique<Peer<Hierarchical>>();
  return std::make_unique<Peer<Plain>>();
}

}  // namespace bench

#else

namespace bench {

std::unique_ptr<CgalPeer> make_cgal_peer(bool) { return nullptr; }

}  // namespace bench

#endif
