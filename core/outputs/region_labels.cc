#include "core/outputs/region_labels.h"

// The graph's edge iterators hold an optional that GCC takes for uninitialised.
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"

#include <algorithm>
#include <boost/graph/adjacency_list.hpp>
#include <boost/graph/boykov_kolmogorov_max_flow.hpp>
#include <cstdint>

namespace plumbline {
namespace {

using GraphTraits = boost::adjacency_list_traits<boost::vecS, boost::vecS, boost::directedS>;
using Graph = boost::adjacency_list<
    boost::vecS,
    boost::vecS,
    boost::directedS,
    boost::property<boost::vertex_color_t,
                    boost::default_color_type,
                    boost::property<boost::vertex_distance_t,
                                    int64_t,
                                    boost::property<boost::vertex_predecessor_t,
                                                    GraphTraits::edge_descriptor>>>,
    boost::property<boost::edge_capacity_t,
                    int64_t,
                    boost::property<boost::edge_residual_capacity_t,
                                    int64_t,
                                    boost::property<boost::edge_reverse_t,
                                                    GraphTraits::edge_descriptor>>>>;

// Whole numbers: the flow then has no rounding errors that could leave a cut unsaturated.
int64_t Capacity(double cost) {
  constexpr double kUnitsPerCost = 1e6;
  constexpr double kMaxCost = 1e9;
  return static_cast<int64_t>(std::min(cost, kMaxCost) * kUnitsPerCost);
}

void Connect(size_t from, size_t to, int64_t forth, int64_t back, Graph* graph) {
  const auto edge = boost::add_edge(from, to, *graph).first;
  const auto reverse = boost::add_edge(to, from, *graph).first;
  boost::put(boost::edge_capacity, *graph, edge, forth);
  boost::put(boost::edge_capacity, *graph, reverse, back);
  boost::put(boost::edge_reverse, *graph, edge, reverse);
  boost::put(boost::edge_reverse, *graph, reverse, edge);
}

}  // namespace

std::vector<bool> LabelRegions(const std::vector<CellCost>& cells,
                               const std::vector<BorderCost>& borders) {
  const size_t source = cells.size();  // stands for free
  const size_t sink = source + 1;
  Graph graph(cells.size() + 2);
  for (size_t i = 0; i < cells.size(); ++i) {
    // A cell on the sink's side pays for being solid.
    Connect(source, i, Capacity(cells[i].solid), 0, &graph);
    Connect(i, sink, Capacity(cells[i].free), 0, &graph);
  }
  for (const BorderCost& border : borders) {
    const int64_t capacity = Capacity(border.cost);
    if (border.a != border.b && capacity > 0) {
      Connect(border.a, border.b, capacity, capacity, &graph);
    }
  }
  boost::boykov_kolmogorov_max_flow(graph, source, sink);
  const auto colours = boost::get(boost::vertex_color, graph);
  const auto free = boost::get(colours, source);
  std::vector<bool> labels;
  for (size_t i = 0; i < cells.size(); ++i) labels.push_back(boost::get(colours, i) == free);
  return labels;
}

}  // namespace plumbline
