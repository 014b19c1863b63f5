"""Encoder and camera against geometry, and against the tables of the thesis."""

import math

import numpy as np
import pytest

from design.rig.camera import CALIBRATION_HEIGHT_M, LENS_LINES, Camera, Frame
from design.rig.encoder import Encoder
from tests.refusals import refused

TABLE_DEGREES = (1, 2, 3, 5, 7)
TABLE_PIXELS = {"6mm": (12, 25, 38, 68, 96), "4mm": (9, 19, 27, 44, 65)}
TABLE_MM = (8.72, 17.46, 26.2, 43.74, 61.4)
LENSES = list(LENS_LINES)


def hanging(degrees_x: float, degrees_y: float, cable_length_m: float) -> np.ndarray:
    """Return where the hook is, of a cable at angles from the vertical."""
    slopes = np.tan(np.radians([degrees_x, degrees_y]))
    down = cable_length_m / math.sqrt(1 + float(slopes @ slopes))
    return np.array([down * slopes[0], down * slopes[1], -down])


def test_the_tables_were_measured_at_one_height() -> None:
    heights = np.array(TABLE_MM) / np.tan(np.radians(TABLE_DEGREES)) / 1000
    assert heights == pytest.approx(CALIBRATION_HEIGHT_M, abs=6e-4)  # 0.005 mm of 8.72 mm


@pytest.mark.parametrize(("lens", "worst"), [("6mm", 0.094), ("4mm", 0.181)])
def test_the_lines_are_the_least_squares_through_the_tables(lens: str, worst: float) -> None:
    pixels = np.array(TABLE_PIXELS[lens], dtype=float)
    slope, offset = np.polyfit(pixels, np.array(TABLE_DEGREES, dtype=float), 1)
    line = LENS_LINES[lens]
    assert line.degrees_per_pixel == pytest.approx(slope, abs=5e-7)
    assert line.offset_deg == pytest.approx(offset, abs=5e-7)
    off = np.abs(line.degrees(pixels) - TABLE_DEGREES)
    assert off.max() == pytest.approx(worst, abs=5e-4)


@pytest.mark.parametrize("lens", LENSES)
def test_the_camera_sees_the_pixels_of_the_tables(lens: str) -> None:
    camera = Camera(line=LENS_LINES[lens], noise_pixels=0.0, whole_pixels=False)
    for degrees, pixels in zip(TABLE_DEGREES, TABLE_PIXELS[lens], strict=True):
        frame = camera.frame(hanging(degrees, 0, 0.5), np.random.default_rng(0))
        slope = LENS_LINES[lens].degrees_per_pixel
        assert abs(frame.pixels[0] - pixels) * slope < 0.2  # the table is off its line by 0.181
    ratio = 6 / 4  # focal lengths over one sensor
    focal = [Camera(line=LENS_LINES[name]).focal_pixels for name in ("6mm", "4mm")]
    assert focal[0] / focal[1] == pytest.approx(ratio, rel=0.03)


@pytest.mark.parametrize("lens", LENSES)
@pytest.mark.parametrize("below_m", [0.0, 0.1])
def test_a_swing_is_found_within_a_fifth_of_a_degree(lens: str, below_m: float) -> None:
    camera = Camera(line=LENS_LINES[lens], below_m=below_m)
    noise = np.random.default_rng(7)
    worst = 0.0
    for length in np.linspace(0.5, 1.2, 15):
        for degrees in np.linspace(-12, 12, 25):
            other = float(noise.uniform(-8, 8))
            frame = camera.frame(hanging(degrees, other, length), noise)
            found = np.degrees(camera.angles_rad(frame, float(length)))
            worst = max(worst, float(np.abs(found - [degrees, other]).max()))
    assert 0.02 < worst < 0.2  # pixels are 0.07 and 0.11 degrees


@pytest.mark.parametrize("lens", LENSES)
@pytest.mark.parametrize("below_m", [0.0, 0.1])
def test_without_noise_the_hook_is_where_it_is(lens: str, below_m: float) -> None:
    camera = Camera(line=LENS_LINES[lens], below_m=below_m, noise_pixels=0, whole_pixels=False)
    noise = np.random.default_rng(1)
    for _ in range(50):
        length = float(noise.uniform(0.5, 1.2))
        hook = hanging(float(noise.uniform(-30, 30)), float(noise.uniform(-30, 30)), length)
        assert camera.hook_m(camera.frame(hook, noise), length) == pytest.approx(hook, abs=1e-12)


@pytest.mark.parametrize("lens", LENSES)
def test_a_wrong_height_is_told(lens: str) -> None:
    camera = Camera(line=LENS_LINES[lens], marker_m=0.1)
    noise = np.random.default_rng(3)
    told = right = 0
    for length in np.linspace(0.5, 1.2, 8):
        for degrees in np.linspace(-10, 10, 11):
            frame = camera.frame(hanging(degrees, 3.0, length), noise)
            camera.angles_rad(frame, float(length))
            right += 1
            for wrong in (0.85, 1.2):
                with refused("height_unlike_marker", "cable_length_m", says="pixels wide"):
                    camera.angles_rad(frame, float(wrong * length))
                told += 1
    assert (right, told) == (88, 176)


def test_how_wrong_a_height_must_be_is_what_the_width_tells() -> None:
    camera = Camera(noise_pixels=0.2)
    size = camera.focal_pixels * camera.marker_m
    frame = Frame(pixels=(0.0, 0.0), width_pixels=40.0)
    assert camera.height_m(frame) == pytest.approx((size / 41.5, size / 38.5))
    assert camera.height_m(Frame(pixels=(0.0, 0.0), width_pixels=1.0))[1] == math.inf


def test_what_a_camera_cannot_see_is_refused() -> None:
    camera = Camera(below_m=0.6)
    with refused("marker_not_below_camera", "hook_m"):
        camera.frame(hanging(0, 0, 0.5), np.random.default_rng(0))
    frame = Frame(pixels=(2000.0, 0.0), width_pixels=40.0)
    with refused("height_unlike_marker"):
        camera.hook_m(frame, 0.5)
    with refused("not_positive", "marker_m"):
        Camera(marker_m=0.0)
    with refused("not_positive", "frame_time_s"):
        Camera(frame_time_s=0.0)
    with refused("out_of_range", "noise_pixels"):
        Camera(noise_pixels=-1.0)


def test_an_encoder_counts_whole_pulses() -> None:
    encoder = Encoder()
    assert encoder.pulse_m == pytest.approx(0.1 / 512, rel=1e-15)
    positions = np.random.default_rng(0).uniform(-0.3, 1.3, 500)
    pulses = encoder.pulses(positions)
    assert np.all(pulses * encoder.pulse_m <= positions)
    assert np.all(positions < (pulses + 1) * encoder.pulse_m)
    told = np.array([encoder.position_m(one) for one in positions.tolist()])
    assert np.abs(told - positions).max() <= encoder.pulse_m / 2 * (1 + 1e-9)
    with refused("no_pulses", "pulses_per_revolution"):
        Encoder(pulses_per_revolution=0)
    with refused("not_positive", "travel_per_revolution_m"):
        Encoder(travel_per_revolution_m=0.0)
