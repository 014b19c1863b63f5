"""The figure that every picture is drawn on."""

from matplotlib.figure import Figure

from design.pictures.files import figure_bytes


class Sheet(Figure):
    """A figure that a notebook shows as it is, without a magic word or a window."""

    def _repr_png_(self) -> bytes:
        return figure_bytes(self, "png")
