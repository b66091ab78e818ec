"""A film of heavy fluid that is let go in a box of light fluid, cell by cell."""

import pyvista, laguerre as lg

scene = lg.scene("dam-break", 400)
film = pyvista.Plotter(off_screen=True, window_size=(480, 320))
film.open_gif("dam.gif")  # this needs imageio


def frame(told):
    cells = lg.cells(told["points"], told["weights"], domain=scene["domain"], geometry=True).to_pyvista().rotate_x(90)  # up is y there, z here
    film.add_mesh(cells, scalars=scene["densities"][cells["site"]], name="cells", cmap="Blues", show_edges=True, show_scalar_bar=False)
    film.write_frame()


lg.fluid(**scene, steps=40, callback=frame)
film.close()
