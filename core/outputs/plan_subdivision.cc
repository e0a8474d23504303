#include "core/outputs/plan_subdivision.h"

#include <CGAL/Arr_curve_data_traits_2.h>
#include <CGAL/Arr_extended_dcel.h>
#include <CGAL/Arr_segment_traits_2.h>
#include <CGAL/Arrangement_2.h>
#include <CGAL/Exact_predicates_exact_constructions_kernel.h>

#include <algorithm>

namespace plumbline {
namespace {

struct Least {
  int operator()(int a, int b) const { return std::min(a, b); }
};

using Kernel = CGAL::Exact_predicates_exact_constructions_kernel;
using SegmentTraits = CGAL::Arr_segment_traits_2<Kernel>;
using Traits = CGAL::Arr_curve_data_traits_2<SegmentTraits, int, Least>;
using Dcel = CGAL::Arr_extended_dcel<Traits, int, int, int>;  // each numbered
using Arrangement = CGAL::Arrangement_2<Traits, Dcel>;

}  // namespace

PlanSubdivision Subdivide(const std::vector<PlanSegment>& segments) {
  std::vector<Traits::Curve_2> curves;
  for (const PlanSegment& segment : segments) {
    if (segment.a == segment.b) continue;
    curves.emplace_back(SegmentTraits::Curve_2(Kernel::Point_2(segment.a.x(), segment.a.y()),
                                               Kernel::Point_2(segment.b.x(), segment.b.y())),
                        segment.label);
  }
  Arrangement arrangement;
  CGAL::insert(arrangement, curves.begin(), curves.end());

  PlanSubdivision plan;
  for (auto v = arrangement.vertices_begin(); v != arrangement.vertices_end(); ++v) {
    v->set_data(static_cast<int>(plan.points.size()));
    plan.points.emplace_back(CGAL::to_double(v->point().x()), CGAL::to_double(v->point().y()));
  }
  int num_half_edges = 0;
  for (auto e = arrangement.halfedges_begin(); e != arrangement.halfedges_end(); ++e) {
    e->set_data(num_half_edges++);
  }
  int num_cells = 0;
  for (auto f = arrangement.faces_begin(); f != arrangement.faces_end(); ++f) {
    f->set_data(num_cells++);
    PlanSubdivision::Cell& cell = plan.cells.emplace_back();
    cell.is_unbounded = f->is_unbounded();
    for (auto loop = f->outer_ccbs_begin(); loop != f->outer_ccbs_end(); ++loop) {
      cell.loops.push_back((*loop)->data());
    }
    for (auto loop = f->inner_ccbs_begin(); loop != f->inner_ccbs_end(); ++loop) {
      cell.loops.push_back((*loop)->data());
    }
  }
  for (auto e = arrangement.halfedges_begin(); e != arrangement.halfedges_end(); ++e) {
    plan.half_edges.push_back({e->source()->data(),
                               e->target()->data(),
                               e->twin()->data(),
                               e->next()->data(),
                               e->face()->data(),
                               e->curve().data()});
  }
  return plan;
}

}  // namespace plumbline
