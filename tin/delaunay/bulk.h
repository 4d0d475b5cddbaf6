// Building a whole Delaunay mesh from vertices that are stored along the Hilbert curve.
//
// Insertion in three rounds along the curve, every 64th vertex, every 8th, then all: a biased order that
// keeps walks short and cavities small, with no randomness in it. The vertex in slot v brings the triangle
// slots 2v - 2 and 2v - 1, and a cavity's slots are used again within it, so triangles end up stored along
// the curve as well.
//
// Several threads: the first round is done by one. Then each thread gets a stretch of the curve, its
// territory. A triangle belongs to a territory when all its vertices do; the others (mixed ones, among them
// the infinite ones) are frozen. A thread inserts a vertex when all triangles in conflict are its own, else
// it leaves the vertex for the end, when one thread inserts what was left. No locks are needed: a thread
// writes its own triangles, and in frozen ones the link over an edge between two of its vertices, of which a
// mixed triangle has at most one; it reads triangles that have an edge with a vertex of its own, and of
// frozen ones only links that no other thread writes. The mesh is canonical, so it is the same for any number
// of threads.
#pragma once

#include <functional>

#include "tin/base/progress.h"
#include "tin/mesh/mesh.h"

namespace tin::delaunay {

/// Requires: mesh.begin_bulk() was called and all points are set, distinct, along the Hilbert curve (any
/// other order gives the same mesh more slowly); threads >= 1. False when `progress` was cancelled: then the
/// mesh is to be thrown away. `meanwhile`, if given, is called once, on a thread that would have nothing to
/// do during the first round if there are several; it may read the mesh's points.
bool build_bulk(mesh::Mesh& mesh, unsigned threads, base::Progress* progress,
                const std::function<void()>& meanwhile = {});

}  // namespace tin::delaunay
