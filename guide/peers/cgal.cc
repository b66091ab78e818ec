#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Regular_triangulation_3.h>
#include <CGAL/Regular_triangulation_cell_base_3.h>
#include <CGAL/Regular_triangulation_vertex_base_3.h>
#include <CGAL/Triangulation_vertex_base_with_info_3.h>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <vector>

// Which cells of the power diagram touch, in all of space: a line for each site, its number and those of its neighbours.
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Vertex = CGAL::Triangulation_vertex_base_with_info_3<int, Kernel, CGAL::Regular_triangulation_vertex_base_3<Kernel>>;
using Structure = CGAL::Triangulation_data_structure_3<Vertex, CGAL::Regular_triangulation_cell_base_3<Kernel>>;
using Regular = CGAL::Regular_triangulation_3<Kernel, Structure>;

int main(int, char** arguments) {
    std::vector<std::pair<Regular::Weighted_point, int>> sites;
    std::ifstream file(arguments[1]);  // id x y z radius
    int id;
    for (double x, y, z, r; file >> id >> x >> y >> z >> r;) sites.push_back({Regular::Weighted_point({x, y, z}, r * r), id});
    Regular diagram(sites.begin(), sites.end());  // (a hidden site has no vertex)
    for (auto vertex : diagram.finite_vertex_handles()) {
        std::vector<Regular::Vertex_handle> others;
        diagram.finite_adjacent_vertices(vertex, std::back_inserter(others));
        std::printf("%d:", vertex->info());
        for (auto other : others) std::printf(" %d", other->info());
        std::printf("\n");
    }
}
