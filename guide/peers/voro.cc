// voro++: volume of each radical cell in the unit cube. Reads rows of id, x, y, z, radius.
#include <voro++/voro++.hh>
#include <cstdio>

int main() {
    voro::container_poly box(0, 1, 0, 1, 0, 1, 6, 6, 6, false, false, false, 8);
    box.import("spheres.txt");
    voro::c_loop_all loop(box);
    voro::voronoicell_neighbor cell;
    if (loop.start()) do {
        if (box.compute_cell(cell, loop)) std::printf("%d %.17g\n", loop.pid(), cell.volume());
    } while (loop.inc());
}
