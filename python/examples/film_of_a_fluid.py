"""A film of heavy fluid that is let go in a box of light fluid, cell by cell."""

import pyvista, laguerre as lg

scene = lg.scene("dam-break", 1_000)
film = pyvista.Plotter(off_screen=True)
film.open_gif("dam.gif")  # this needs imageio


def frame(told):
    cells = lg.cells(told["points"], told["weights"], domain=scene["domain"], geometry=True).to_pyvista()
    film.add_mesh(cells, scalars=scene["densities"][cells["site"]], name="cells", show_scalar_bar=False)
    film.write_frame()


lg.fluid(**scene, steps=10, callback=frame)
film.close()
