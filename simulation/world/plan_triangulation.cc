#include "simulation/world/plan_triangulation.h"

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_exact_constructions_kernel.h>
#include <CGAL/Triangulation_face_base_with_info_2.h>

namespace plumbline {
namespace {

using Kernel = CGAL::Exact_predicates_exact_constructions_kernel;
using FaceBase = CGAL::Triangulation_face_base_with_info_2<
    int,
    Kernel,
    CGAL::Constrained_triangulation_face_base_2<Kernel>>;
using TriangulationData =
    CGAL::Triangulation_data_structure_2<CGAL::Triangulation_vertex_base_2<Kernel>, FaceBase>;
using Triangulation =
    CGAL::Constrained_Delaunay_triangulation_2<Kernel,
                                               TriangulationData,
                                               CGAL::Exact_intersections_tag>;

}  // namespace

std::vector<PlanTriangle> TriangulatePlan(const std::vector<PlanLine>& segments) {
  Triangulation triangulation;
  for (const PlanLine& segment : segments) {
    triangulation.insert_constraint({segment.from.x(), segment.from.y()},
                                    {segment.to.x(), segment.to.y()});
  }
  int num_triangles = 0;
  for (const auto face : triangulation.all_face_handles()) {
    face->info() = triangulation.is_infinite(face) ? kNoTriangle : num_triangles++;
  }
  std::vector<PlanTriangle> triangles;
  for (const auto face : triangulation.finite_face_handles()) {
    PlanTriangle& triangle = triangles.emplace_back();
    for (int i = 0; i < 3; ++i) {
      const auto& point = face->vertex(i)->point();
      const auto index = static_cast<size_t>(i);
      triangle.corners[index] = {CGAL::to_double(point.x()), CGAL::to_double(point.y())};
      // Neighbour k is opposite to vertex k.
      triangle.neighbours[index] = face->neighbor((i + 2) % 3)->info();
    }
  }
  return triangles;
}

}  // namespace plumbline
