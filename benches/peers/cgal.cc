// CGAL: the Delaunay triangulation alone, on one thread: no cells, volumes or centroids. Reads rows of x, y, z; says seconds of the second of two runs.
#include <CGAL/Delaunay_triangulation_3.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <chrono>
#include <cstdio>
#include <fstream>
#include <vector>

int main(int, char** arguments) {
    using Delaunay = CGAL::Delaunay_triangulation_3<CGAL::Exact_predicates_inexact_constructions_kernel>;
    std::vector<Delaunay::Point> sites;
    std::ifstream file(arguments[1]);
    for (double x, y, z; file >> x >> y >> z;) sites.emplace_back(x, y, z);
    double seconds = 0;
    for (int run = 0; run < 2; ++run) {
        const auto begin = std::chrono::steady_clock::now();
        Delaunay triangulation(sites.begin(), sites.end());
        seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
        if (triangulation.number_of_vertices() == 0) return 1;
    }
    std::printf("%.6f\n", seconds);
}
