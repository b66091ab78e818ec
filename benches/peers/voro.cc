// voro++: volume and centroid of each cell in the unit cube, on one thread. Reads rows of x, y, z; says seconds of the second of two runs, the sum of the
// volumes and that of their squares.
#include <chrono>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <vector>
#include <voro++/voro++.hh>

int main(int, char** arguments) {
    std::vector<double> sites;
    std::ifstream file(arguments[1]);
    for (double x; file >> x;) sites.push_back(x);
    const int count = sites.size() / 3;
    // As many blocks as its own guess makes (`pre_container::guess_optimal`).
    const int blocks = std::cbrt(count / voro::optimal_particles) + 1;
    double seconds = 0, sum = 0, squares = 0;
    for (int run = 0; run < 2; ++run) {
        std::vector<double> volumes(count), centroids(3 * count);
        const auto begin = std::chrono::steady_clock::now();
        voro::container box(0, 1, 0, 1, 0, 1, blocks, blocks, blocks, false, false, false, 8);
        for (int i = 0; i < count; ++i) box.put(i, sites[3 * i], sites[3 * i + 1], sites[3 * i + 2]);
        voro::c_loop_all loop(box);
        voro::voronoicell cell;
        if (loop.start()) do {
            if (!box.compute_cell(cell, loop)) continue;
            const int i = loop.pid();
            volumes[i] = cell.volume();
            cell.centroid(centroids[3 * i], centroids[3 * i + 1], centroids[3 * i + 2]);
        } while (loop.inc());
        seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
        sum = squares = 0;
        for (double volume : volumes) sum += volume, squares += volume * volume;
    }
    std::printf("%.6f %.17g %.17g\n", seconds, sum, squares);
}
