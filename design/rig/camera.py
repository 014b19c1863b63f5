r"""The camera at the trolley that looks down at a marker on the hook (Kim 2011, figure 2-8).

A marker that hangs A below the camera and B beside it is seen at the angle ``a = atan(B / A)``, and
its centre at ``f tan(a - c)`` pixels: f is the focal length in pixels, and c the angle at which the
camera is mounted. The image is binarised, and the centre of the marker's pixels is found to a whole
pixel, give or take the noise. Tables 2-2 and 2-3 were measured at one height, 499.9 mm: the angle
is found from pixels alone, a deflection or the swing of a cable only with the height. The width of
the marker in the image says how far away it is, so that a wrong height is found out.
"""

import math
from dataclasses import dataclass

import numpy as np

from design.checks import MAX_VALUE, require_between, require_scale
from design.errors import InvalidInputError
from design.types import FloatArray

CALIBRATION_HEIGHT_M = 0.4999
"""Height from camera to marker at which the tables were measured: 61.4 mm are 7 degrees [m]."""

MARKER_M = 0.04
"""Width of the marker; an assumption, the thesis does not say [m]."""

MAX_NOISES = 5.0
"""Noises by which a width may be off its height: more happens once in a million frames [-]."""

ROUNDING = 1e-12
"""Share of a width that is lost in computing it [-]."""

WHOLE_PIXEL = 0.5
"""Most by which a whole pixel is off [pixels]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class CalibrationLine:
    """Angle of a marker over its pixels, as a line.

    Attributes
    ----------
    degrees_per_pixel, offset_deg
        The line.
    """

    degrees_per_pixel: float
    offset_deg: float

    def degrees(self, pixels: FloatArray) -> FloatArray:
        """Return the angles that the line says, shape (n,) [degrees]."""
        return self.degrees_per_pixel * pixels + self.offset_deg


LENS_LINES = {
    "6mm": CalibrationLine(degrees_per_pixel=0.070774, offset_deg=0.216989),
    "4mm": CalibrationLine(degrees_per_pixel=0.108869, offset_deg=0.029086),
}
"""Least squares through tables 2-2 and 2-3 of Kim 2011, by the focal length of the lens."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Frame:
    """What is found in an image.

    Attributes
    ----------
    pixels
        Centre of the marker in x and y, from the middle of the image [pixels].
    width_pixels
        Width of the marker [pixels].
    """

    pixels: tuple[float, float]
    width_pixels: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Camera:
    """A camera of the mini-crane, with one of its lenses."""

    line: CalibrationLine = LENS_LINES["6mm"]
    marker_m: float = MARKER_M  # Width of the marker, > 0 [m]
    # How far the camera is below the point where the cable hangs [m]
    below_m: float = 0.0
    noise_pixels: float = 0.3  # Standard deviation of centre and width, before rounding [pixels]
    whole_pixels: bool = True  # Whether centre and width are rounded to whole pixels
    frame_time_s: float = 1 / 30  # Time between images, > 0 [s]

    def __post_init__(self) -> None:
        for name in ("marker_m", "frame_time_s"):
            require_scale(name, getattr(self, name))
        require_between("below_m", self.below_m, -MAX_VALUE, MAX_VALUE)
        require_between("noise_pixels", self.noise_pixels, 0.0, MAX_VALUE)

    @property
    def focal_pixels(self) -> float:
        """Focal length, of the slope of the line [pixels]."""
        return 1 / math.tan(math.radians(self.line.degrees_per_pixel))

    def frame(self, hook_m: FloatArray, noise: np.random.Generator) -> Frame:
        """Return what the camera finds of a marker.

        Parameters
        ----------
        hook_m
            The marker from the point where the cable hangs, x, y and z upward, shape (3,) [m].
        noise
            Where its noise comes from: three normal numbers a frame.

        Returns
        -------
        Frame
            Its centre and width.

        Raises
        ------
        InvalidInputError
            If the marker is not below the camera.
        """
        height = -float(hook_m[2]) - self.below_m
        if height <= 0:
            raise InvalidInputError(
                "hook_m",
                f"a marker {height:.4g} m below the camera",
                "below the camera",
                code="marker_not_below_camera",
            )
        focal, mounted = self.focal_pixels, math.radians(self.line.offset_deg)
        exact = [focal * math.tan(math.atan2(float(hook_m[k]), height) - mounted) for k in (0, 1)]
        exact.append(focal * self.marker_m / height)
        seen = np.array(exact) + self.noise_pixels * noise.standard_normal(3)
        if self.whole_pixels:
            seen = np.round(seen)
        return Frame(pixels=(float(seen[0]), float(seen[1])), width_pixels=float(seen[2]))

    def height_m(self, frame: Frame) -> tuple[float, float]:
        """Return how far below the camera a marker must be, at least and at most.

        Parameters
        ----------
        frame
            What was found.

        Returns
        -------
        tuple of float
            Heights at which its width is within five noises and the rounding [m]; the second is
            infinite where the marker is as small as these.
        """
        off = MAX_NOISES * self.noise_pixels + (WHOLE_PIXEL if self.whole_pixels else 0.0)
        off += ROUNDING * frame.width_pixels
        size = self.focal_pixels * self.marker_m
        least = size / (frame.width_pixels + off)
        narrow = frame.width_pixels - off
        return least, (size / narrow if narrow > 0 else math.inf)

    def hook_m(self, frame: Frame, cable_length_m: float) -> FloatArray:
        """Return where the marker of a frame is.

        Parameters
        ----------
        frame
            What was found.
        cable_length_m
            From the point where the cable hangs to the marker [m].

        Returns
        -------
        FloatArray
            The marker from the point where the cable hangs, shape (3,) [m].

        Raises
        ------
        InvalidInputError
            If no cable of this length reaches the line of sight, or the width of the marker says
            another height.

        Notes
        -----
        With slopes ``t`` of the line of sight, ``A^2 t^2 + (A + below)^2 = L^2`` gives the height A
        from camera to marker.
        """
        require_scale("cable_length_m", cable_length_m)
        mounted = math.radians(self.line.offset_deg)
        slopes = [
            math.tan(math.atan(pixels / self.focal_pixels) + mounted) for pixels in frame.pixels
        ]
        slope2 = slopes[0] ** 2 + slopes[1] ** 2
        inside = cable_length_m**2 * (1 + slope2) - self.below_m**2 * slope2
        height = (math.sqrt(max(inside, 0.0)) - self.below_m) / (1 + slope2)
        least, most = self.height_m(frame)
        if not (inside > 0 and least <= height <= most):
            raise InvalidInputError(
                "cable_length_m",
                cable_length_m,
                f"that of the cable: the marker is {frame.width_pixels:.4g} pixels wide, as "
                f"{least:.4g} to {most:.4g} m below the camera",
                code="height_unlike_marker",
            )
        return np.array([height * slopes[0], height * slopes[1], -height - self.below_m])

    def angles_rad(self, frame: Frame, cable_length_m: float) -> FloatArray:
        """Return the angles of the cable from the vertical in x and y.

        Parameters
        ----------
        frame
            What was found.
        cable_length_m
            From the point where the cable hangs to the marker [m].

        Returns
        -------
        FloatArray
            Positive where the marker is ahead, shape (2,) [rad].

        Raises
        ------
        InvalidInputError
            If the width of the marker says another height.
        """
        hook = self.hook_m(frame, cable_length_m)
        angles: FloatArray = np.arctan2(hook[:2], -hook[2])
        return angles
