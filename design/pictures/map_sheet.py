"""A residual map as a picture."""

import numpy as np
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure

from design.maps import Axis, ResidualMap
from design.pictures.style import house_style

SMALLEST_DRAWN = 1e-4
"""Residuals below a hundredth of a percent are drawn alike [-]."""

LEVELS = (0.01, 0.05, 0.2)
"""Lines of equal residual [-]."""


def map_sheet(title: str, x: Axis, y: Axis, found: ResidualMap) -> Figure:
    """Draw the residual over two fields, with lines at 1, 5 and 20 %."""
    with house_style():
        figure = Figure(figsize=(7.2, 5.6))
        axes = figure.add_axes((0.13, 0.12, 0.7, 0.76))
        percent = 100 * np.clip(found.residuals, SMALLEST_DRAWN, None)
        mesh = axes.pcolormesh(
            x.values,
            y.values,
            np.ma.masked_invalid(percent),
            norm=LogNorm(vmin=100 * SMALLEST_DRAWN, vmax=100),
            cmap="cividis",
            shading="nearest",
            rasterized=True,
        )
        inside = [
            level
            for level in LEVELS
            if np.nanmin(found.residuals) < level < np.nanmax(found.residuals)
        ]
        if inside and min(found.residuals.shape) > 1:
            lines = axes.contour(
                x.values,
                y.values,
                np.ma.masked_invalid(100 * found.residuals),
                levels=[100 * level for level in inside],
                colors="white",
                linewidths=1.0,
            )
            axes.clabel(lines, fmt="%g %%", fontsize=8)
        axes.set_xlabel(_label(x))
        axes.set_ylabel(_label(y))
        axes.set_title(title, loc="left", pad=12)
        bar = figure.add_axes((0.86, 0.12, 0.025, 0.76))
        figure.colorbar(mesh, cax=bar, label="residual vibration [%]")
        return figure


UNITS = ("rad_s", "m_s2", "m_s", "s", "m")


def _label(axis: Axis) -> str:
    """Name a field in words, its unit in brackets."""
    name = axis.path[-1]
    unit = next((unit for unit in UNITS if name.endswith(f"_{unit}")), "")
    words = " ".join([*axis.path[1:-1], name.removesuffix(f"_{unit}").replace("_", " ")])
    return f"{words} [{unit.replace('_', '/').replace('s2', 's²') or '-'}]"
