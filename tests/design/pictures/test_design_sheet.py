"""The design sheet: what it shows is what was designed, and its bytes repeat."""

import io
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from functools import cache
from typing import Literal
from xml.etree import ElementTree

import matplotlib as mpl
import numpy as np
import pytest
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.image import imread
from matplotlib.patches import Rectangle
from matplotlib.text import Annotation

from design.analysis.residual import residual_vibration
from design.analysis.sensitivity import Sensitivity, SensitivityRange, sensitivity
from design.model.actuators.first_order import FirstOrder
from design.model.actuators.ideal import Ideal
from design.model.actuators.model import Model
from design.model.actuators.rate_limited import RateLimited
from design.model.actuators.registry import Actuator
from design.model.actuators.second_order import SecondOrder, SecondOrderSet
from design.model.impulses import Impulses
from design.model.plants.mode import Mode
from design.model.plants.modes import Modes
from design.model.plants.pendulum import Pendulum
from design.model.plants.registry import Plant
from design.model.plants.scheduled import Scheduled
from design.model.plants.spring_mass import SpringMass
from design.pictures.design_sheet import design_sheet
from design.pictures.files import figure_bytes
from design.pictures.sensitivity_panel import draw_sensitivity
from design.pictures.style import AMBER, PROVEN, percent
from design.pictures.time_panels import draw_payload
from design.pictures.vector_panel import draw_vectors, lie_on_one_another, vibration_vectors
from design.pictures.words import actuator_in_words, plant_in_words
from design.pipeline import Design, design
from design.response.closed_form import history
from design.shapers.numsi import UnityBandOptions
from design.shapers.registry import POSITIVE, SHAPERS
from design.shapers.specified_insensitivity import BandOptions
from tests.design.model.actuators.test_rate_limited import random_case
from tests.design.pictures.drawn import collisions, line, panel, words
from tests.expm_route import end_s

CABLE = Pendulum(cable_length_m=0.8, gravity_m_s2=9.81)
CRANE = CABLE.mode
THREE = Modes(
    modes=(
        Mode(natural_frequency_rad_s=3.5),
        Mode(natural_frequency_rad_s=9.4, damping_ratio=0.02),
        Mode(natural_frequency_rad_s=21.3, damping_ratio=0.05),
    )
)
TWO = Modes(modes=THREE.modes[:2])
SIX = Modes(modes=tuple(Mode(natural_frequency_rad_s=3.5 * 1.4**turn) for turn in range(6)))
CRANE_DRIVE = SecondOrder(
    accel=SecondOrderSet(natural_frequency_rad_s=20.0, damping_ratio=0.8),
    decel=SecondOrderSet(natural_frequency_rad_s=50.0, damping_ratio=1.5),
)
LAG = FirstOrder(accel_time_constant_s=0.1, decel_time_constant_s=0.04)
EQUAL = FirstOrder(accel_time_constant_s=0.05, decel_time_constant_s=0.05)
RAMPS = RateLimited(accel_limit_m_s2=4.0, decel_limit_m_s2=3.0, speed_m_s=0.4)
VERSION = "1.2.3"
WHOLE_RANGE = SensitivityRange()
ROUNDING = 1e-13
"""Sums of a few numbers of magnitude one, each right to double precision."""

CASES: dict[str, tuple[str, Mode, Actuator]] = {
    "numzvd behind the thesis's actuator": ("numzvd", CRANE, CRANE_DRIVE),
    "numzv behind the thesis's actuator": ("numzv", CRANE, CRANE_DRIVE),
    "umzvd behind the thesis's actuator": ("umzvd", CRANE, CRANE_DRIVE),
    "umzv behind the thesis's actuator": ("umzv", CRANE, CRANE_DRIVE),
    "damped": ("numzvd", Mode(natural_frequency_rad_s=3.5, damping_ratio=0.2), LAG),
    # Long numbers: a narrow last pulse, its vectors one upon the other.
    "odd": (
        "umzvd",
        Mode(natural_frequency_rad_s=470.56, damping_ratio=0.2847),
        FirstOrder(accel_time_constant_s=0.00081336, decel_time_constant_s=0.0010490),
    ),
    "ideal": ("umzvd", CRANE, Ideal()),
    "slow": ("numzvd", Mode(natural_frequency_rad_s=0.5), CRANE_DRIVE),
    # Crowded switches and every warning there is.
    "fast": ("numzvd", Mode(natural_frequency_rad_s=60.0, damping_ratio=0.02), CRANE_DRIVE),
}


@cache
def _sheet(
    name: str, mode: Mode, actuator: Actuator, wanted: SensitivityRange = WHOLE_RANGE
) -> tuple[Figure, Design, Sensitivity]:
    made = design(mode, actuator, SHAPERS[name])
    curve = sensitivity(made.impulses, mode, actuator, wanted)
    return design_sheet(name, mode, actuator, made, [curve], VERSION), made, curve


def _has(figure: Figure, name: str, gid: str) -> bool:
    def named(artist: Artist) -> bool:
        return artist.get_gid() == gid

    return bool(panel(figure, name).findobj(named))


@pytest.fixture(scope="module", name="crane_sheet")
def _crane_sheet() -> tuple[Figure, Design, Sensitivity]:
    return _sheet("numzvd", CRANE, CRANE_DRIVE)


def test_every_axis_has_its_unit(crane_sheet: tuple[Figure, Design, Sensitivity]) -> None:
    figure, _, _ = crane_sheet
    units = {axes.get_label(): axes.get_ylabel().split("[")[1] for axes in figure.axes}
    assert units == {
        "impulses": "-]",
        "command": "share of full speed]",
        "payload": "share of unshaped]",
        "vectors": "share of unshaped]",
        "sensitivity": "%]",
    }
    time_axis = panel(figure, "payload")
    assert time_axis.get_xlabel() == "time [s]"
    for above in ("impulses", "command"):
        assert time_axis.get_shared_x_axes().joined(time_axis, panel(figure, above))
    assert panel(figure, "vectors").get_xlabel().endswith("[share of unshaped]")
    assert panel(figure, "sensitivity").get_xlabel().endswith("[-]")


def test_the_header_tells_shaper_plant_actuator_duration_residual_and_proof(
    crane_sheet: tuple[Figure, Design, Sensitivity],
) -> None:
    told = words(crane_sheet[0])
    for fact in ("numzvd", "0.5573 Hz, period 1.794 s", "3.502 rad/s", "shapersmith 1.2.3"):
        assert fact in told
    for fact in ("second order, superposed", "decel 50 rad/s, damping 1.5"):
        assert fact in told
    for fact in ("1.321 s", "below 1e-7 %", "✓ verified", "residual and slope"):
        assert fact in told


def test_a_shaper_verified_for_an_ideal_actuator_says_so_behind_another() -> None:
    told = words(_sheet("umzv", CRANE, CRANE_DRIVE)[0])
    assert "7.34 %" in told
    for fact in ("ideal actuator only", "not proven for the"):
        assert fact in told
        assert fact not in words(_sheet("umzv", CRANE, Ideal())[0])
    assert "✓ verified" not in told


@pytest.mark.parametrize("case", CASES)
def test_amber_is_what_is_not_proven_for_the_actuator_given(case: str) -> None:
    figure, made, _ = _sheet(*CASES[case])
    value = next(
        text for text in figure.texts if text.get_text() in {"✓ verified", "ideal actuator only"}
    )
    assert value.get_color() == (AMBER if made.for_ideal else PROVEN)
    grounds = [one for one in figure.findobj(Rectangle) if one.get_gid() == "not-proven"]
    assert len(grounds) == made.for_ideal


PLANTS: list[tuple[Plant, set[str]]] = [
    (CABLE, {"0.5573 Hz, period 1.794 s", "3.502 rad/s, cable 0.8 m", "damping ratio 0"}),
    (
        SpringMass(mass_kg=2.0, stiffness_n_m=200.0, damping_ratio=0.1),
        {"1.592 Hz, period 0.6283 s", "10 rad/s", "damping ratio 0.1"},
    ),
    (
        Scheduled(first=CABLE, last=replace(CABLE, cable_length_m=0.6)),
        {"0.5573 to 0.6435 Hz", "middle 3.773 rad/s, cable 0.6 to 0.8 m"},
    ),
    (THREE, {"3 modes", "0.557 to 3.39 Hz", "damping ratio 0 to 0.05"}),
]


@pytest.mark.parametrize(("plant", "told"), PLANTS)
def test_the_plant_is_told_in_hertz_with_its_cable(plant: Plant, told: set[str]) -> None:
    value, details = plant_in_words(plant)
    assert told <= {value, *details.splitlines()}


def test_the_largest_residual_of_a_range_is_beside_that_of_its_middle() -> None:
    figure, made = _sheet_of_modes("ei", PLANTS[2][0], Ideal())
    assert made.worst_in_range is not None
    told = f"in the middle of the range, at most {percent(made.worst_in_range)} within it"
    assert told in words(figure)


@pytest.mark.parametrize("model", ["superposed", "switched"])
@pytest.mark.parametrize("drive", [CRANE_DRIVE, LAG, replace(RAMPS, then=LAG)])
def test_the_model_of_an_actuator_is_told(drive: Actuator, model: Model) -> None:
    if isinstance(drive, RateLimited):
        drive = replace(drive, then=replace(LAG, model=model))
    elif not isinstance(drive, Ideal):
        drive = replace(drive, model=model)
    assert model in " ".join(actuator_in_words(drive))
    assert not {"superposed", "switched"} & set(" ".join(actuator_in_words(Ideal())).split())


def test_the_first_warning_is_on_the_sheet_and_the_others_are_counted() -> None:
    figure, made, _ = _sheet(*CASES["fast"])
    told = words(figure)
    assert f"{made.warnings[0].detail}; {len(made.warnings) - 1} more" in told


@pytest.mark.parametrize("image_format", ["png", "svg", "html"])
def test_two_drawings_have_equal_bytes(image_format: Literal["png", "svg", "html"]) -> None:
    _, made, curve = _sheet("numzvd", CRANE, CRANE_DRIVE)
    first, second = (
        design_sheet("numzvd", CRANE, CRANE_DRIVE, made, [curve], VERSION) for _ in range(2)
    )
    image = figure_bytes(first, image_format)
    assert figure_bytes(second, image_format) == image
    assert figure_bytes(first, image_format) == image


def test_threads_and_the_users_settings_change_no_byte_and_find_their_settings_again(
    crane_sheet: tuple[Figure, Design, Sensitivity],
) -> None:
    _, made, curve = crane_sheet

    def svg() -> bytes:
        return figure_bytes(
            design_sheet("numzvd", CRANE, CRANE_DRIVE, made, [curve], VERSION), "svg"
        )

    alone = svg()
    with mpl.rc_context({"lines.linewidth": 9.0, "svg.hashsalt": "another"}):
        before = dict(mpl.rcParams)
        with ThreadPoolExecutor(3) as threads:
            images = [future.result() for future in [threads.submit(svg) for _ in range(3)]]
        assert dict(mpl.rcParams) == before
    assert images == [alone] * 3


def test_the_png_opens_at_its_size(crane_sheet: tuple[Figure, Design, Sensitivity]) -> None:
    pixels = imread(io.BytesIO(figure_bytes(crane_sheet[0], "png")), format="png")
    assert pixels.shape[:2] == (1245, 1650)


def test_the_svg_is_xml_with_a_group_for_each_panel_and_no_date(
    crane_sheet: tuple[Figure, Design, Sensitivity],
) -> None:
    image = figure_bytes(crane_sheet[0], "svg")
    root = ElementTree.fromstring(image)
    assert root.tag == "{http://www.w3.org/2000/svg}svg"
    ids = {element.get("id") for element in root.iter()}
    assert {"impulses", "command", "payload", "vectors", "sensitivity"} <= ids
    assert b"<dc:date>" not in image


def test_the_page_is_the_svg_with_a_title_and_asks_no_server(
    crane_sheet: tuple[Figure, Design, Sensitivity],
) -> None:
    page = figure_bytes(crane_sheet[0], "html").decode()
    svg = figure_bytes(crane_sheet[0], "svg").decode()
    assert svg[svg.index("<svg") :].strip() in page
    assert "<title>numzvd</title>" in page
    for loads in ("<script", "<link", "<img", "src="):
        assert loads not in page


@pytest.mark.parametrize("case", CASES)
def test_the_sensitivity_drawn_is_the_one_given(case: str) -> None:
    figure, _, curve = _sheet(*CASES[case])
    ratios, residuals = line(figure, "sensitivity", "residual")
    np.testing.assert_array_equal(ratios, curve.frequency_ratios)
    np.testing.assert_array_equal(residuals, 100 * curve.residuals)


def test_the_band_and_its_width_are_told(crane_sheet: tuple[Figure, Design, Sensitivity]) -> None:
    figure, _, _ = crane_sheet
    assert _has(figure, "sensitivity", "band")
    _, tolerance = line(figure, "sensitivity", "tolerance")
    np.testing.assert_allclose(tolerance, 5.0, rtol=1e-15)
    assert "insensitivity 0.8671 to 1.1257, width 0.2587" in words(figure)


def test_a_design_above_tolerance_has_no_band_and_the_sheet_says_so() -> None:
    figure, _, curve = _sheet("umzv", CRANE, CRANE_DRIVE)
    assert curve.insensitivity is None
    assert not _has(figure, "sensitivity", "band")
    assert _has(figure, "sensitivity", "tolerance")
    assert "no insensitivity: nominal 7.34 % is above tolerance" in words(figure)


@pytest.mark.parametrize(
    ("times", "amplitudes", "tolerance", "note", "edges"),
    [
        ([0.0, 1.0], [0.3, 0.3], 0.7, "insensitivity: no edge from 0.001 to 100 times", 0),
        ([0.0, 0.3], [1.0, -0.55], 0.8, "no lower edge down to 0.001 times", 1),
    ],
)
def test_an_edge_that_is_none_is_told_and_not_drawn(
    times: list[float], amplitudes: list[float], tolerance: float, note: str, edges: int
) -> None:
    steps = Impulses(times_s=np.array(times), amplitudes=np.array(amplitudes))
    mode = Mode(natural_frequency_rad_s=1.0)
    curve = sensitivity(steps, mode, Ideal(), SensitivityRange(tolerance=tolerance))
    figure = Figure()
    draw_sensitivity(figure.add_subplot(), [curve], [residual_vibration(steps, mode, Ideal())])
    (axes,) = figure.axes
    assert note in words(figure)
    drawn = [line for line in axes.lines if line.get_linewidth() == pytest.approx(0.9)]
    assert len(drawn) == edges


def test_a_band_beyond_the_range_asked_for_does_not_widen_it() -> None:
    inside = SensitivityRange(from_ratio=1.05, to_ratio=1.1)
    figure, _, _ = _sheet("numzvd", CRANE, CRANE_DRIVE, inside)
    assert panel(figure, "sensitivity").get_xlim() == (1.05, 1.1)


@pytest.mark.parametrize("seed", range(20))
def test_the_vectors_add_up_whatever_the_drive_does(seed: int) -> None:
    impulses, mode, limited = random_case(seed)
    for actuator in (limited, limited.then):
        total = vibration_vectors(impulses, mode, actuator).sum()
        expected = residual_vibration(impulses, mode, actuator)
        assert abs(total) == pytest.approx(expected, rel=1e-9, abs=ROUNDING)


@pytest.mark.parametrize("case", CASES)
def test_the_vector_diagram_is_open_by_the_residual(case: str) -> None:
    figure, made, _ = _sheet(*CASES[case])
    across, up = line(figure, "vectors", "corners")
    assert (across[0], up[0]) == (0, 0)
    assert abs(np.hypot(across[-1], up[-1]) - made.residual) < ROUNDING


def test_numzvd_closes_the_vector_diagram_where_umzv_leaves_a_gap() -> None:
    for name, gap in (("numzvd", 0.0), ("umzv", 0.07337)):
        figure, made, _ = _sheet(name, CRANE, CRANE_DRIVE)
        across, up = line(figure, "vectors", "corners")
        assert across.size == made.impulses.times_s.size + 1
        assert abs(np.hypot(across[-1], up[-1]) - gap) < 1e-5
        assert _has(figure, "vectors", "gap") == (gap > 0)


def test_vectors_of_a_damped_mode_sum_to_the_residual_wherever_time_starts() -> None:
    mode = Mode(natural_frequency_rad_s=4.0, damping_ratio=0.3)
    amplitudes = np.array([0.6, -0.9, 1.1])
    for start_s in (0.0, 7.0):
        impulses = Impulses(
            times_s=start_s + np.array([0.0, 0.2, 0.9]),
            amplitudes=amplitudes,
        )
        vectors = vibration_vectors(impulses, mode, CRANE_DRIVE)
        expected = residual_vibration(impulses, mode, CRANE_DRIVE)
        assert abs(abs(vectors.sum()) - expected) < ROUNDING
        assert vectors[0].imag == 0


def test_the_payload_drawn_rings_on_by_the_residual_and_no_more() -> None:
    for name in ("numzvd", "umzv"):
        figure, made, _ = _sheet(name, CRANE, CRANE_DRIVE)
        times, deflection = line(figure, "payload", "shaped")
        # The slowest actuator pole is at 16 rad/s: after 1 s it has left 1e-6 of a step.
        late = deflection[times > made.impulses.times_s[-1] + 1.0]
        assert abs(np.abs(late).max() - made.residual) < 1e-4


@pytest.mark.parametrize("damping_ratio", [0.0, 0.2, 0.5])
@pytest.mark.parametrize("actuator", [Ideal(), LAG, RAMPS], ids=lambda drive: drive.kind)
def test_a_payload_rings_within_its_envelope_and_touches_it(
    actuator: Actuator, damping_ratio: float
) -> None:
    mode = Mode(natural_frequency_rad_s=3.0, damping_ratio=damping_ratio)
    halves = Impulses(times_s=np.array([0.0, 0.4]), amplitudes=np.array([0.5, 0.5]))
    times = np.linspace(0.0, 4.0, 8001)
    axes = Figure().add_subplot()
    left = residual_vibration(halves, mode, actuator)
    draw_payload(axes, halves, [mode], actuator, [left], times)
    (shaped,) = [line for line in axes.lines if line.get_gid() == "shaped"]
    late = times > 2.4  # transients have e^-20 left
    ended = end_s(halves, actuator)
    envelope = left * np.exp(-3.0 * damping_ratio * (times[late] - ended))
    shares = np.abs(np.asarray(shaped.get_ydata()))[late] / envelope
    assert shares.max() == pytest.approx(1.0, abs=1e-6)  # a maximum between two of the times


@cache
def _sheet_of_modes(name: str, plant: Plant, actuator: Actuator) -> tuple[Figure, Design]:
    made = design(plant, actuator, SHAPERS[name])
    curves = [sensitivity(made.impulses, mode, actuator, WHOLE_RANGE) for mode in plant.modes]
    return design_sheet(name, plant, actuator, made, curves, VERSION), made


@pytest.mark.parametrize("plant", [THREE, SIX])
def test_every_mode_is_drawn_and_named_in_eitherpanel(plant: Modes) -> None:
    figure, made = _sheet_of_modes("convolved", plant, Ideal())
    for number, mode in enumerate(plant.modes):
        curve = sensitivity(made.impulses, mode, Ideal(), WHOLE_RANGE)
        _, residuals = line(figure, "sensitivity", f"residual-{number}")
        np.testing.assert_array_equal(residuals, 100 * curve.residuals)
        times, deflection = line(figure, "payload", f"shaped-{number}")
        exact = history(made.impulses, mode, Ideal(), times).deflection
        shares = deflection[np.abs(exact) > 1e-6] / exact[np.abs(exact) > 1e-6]
        np.testing.assert_allclose(shares, shares[0], rtol=1e-9)
        told = words(figure)
        assert f"{mode.natural_frequency_rad_s / (2 * np.pi):.3g} Hz" in told
        assert f"mode {number}" in told


def _arrows(axes: Axes) -> list[tuple[tuple[float, float], tuple[float, float]]]:
    """Tail and head of each arrow, in the units of the panel."""
    found = [text for text in axes.texts if isinstance(text, Annotation) and text.arrow_patch]
    return [(text.xyann, text.xy) for text in found]


@pytest.mark.parametrize("actuator", [Ideal(), CRANE_DRIVE])
@pytest.mark.parametrize("name", [kind.name for kind in POSITIVE if kind.name != "mzv"])
def test_vectors_along_one_line_have_a_lane_each(name: str, actuator: Actuator) -> None:
    figure, made, _ = _sheet(name, CRANE, actuator)
    axes = panel(figure, "vectors")
    vectors = vibration_vectors(made.impulses, CRANE, actuator)
    arrows = _arrows(axes)
    assert len(arrows) == vectors.size
    lanes = [tail[1] for tail, _ in arrows]
    np.testing.assert_allclose(lanes, np.arange(1, vectors.size + 1), atol=ROUNDING)
    np.testing.assert_allclose([head[1] for _, head in arrows], lanes, atol=ROUNDING)
    lengths = [head[0] - tail[0] for tail, head in arrows]
    np.testing.assert_allclose(lengths, vectors.real, atol=ROUNDING)
    assert [tail[0] for tail, _ in arrows[1:]] == [head[0] for _, head in arrows[:-1]]
    assert len({text.get_text() for text in axes.texts} & {str(n) for n in range(1, 9)}) == len(
        arrows
    )


def test_vectors_that_fold_back_are_set_apart_and_keep_their_direction() -> None:
    options = BandOptions(half_width=0.6, tolerance=0.02)
    made = design(CRANE, Ideal(), SHAPERS["si"], options)
    curve = sensitivity(made.impulses, CRANE, Ideal(), WHOLE_RANGE)
    axes = panel(design_sheet("si", CRANE, Ideal(), made, [curve], VERSION), "vectors")
    vectors = vibration_vectors(made.impulses, CRANE, Ideal())
    places = np.array(_arrows(axes))
    arrows = axes.transData.transform(places.reshape(-1, 2)).reshape(places.shape)
    drawn = [complex(*(head - tail)) for tail, head in arrows]
    np.testing.assert_allclose(np.angle(drawn / vectors), 0.0, atol=1e-9)
    shares = np.abs(drawn) / np.abs(vectors)
    np.testing.assert_allclose(shares, shares[0], rtol=1e-9)
    apart = arrows[:-1, 1, 1] - arrows[1:, 0, 1]
    np.testing.assert_allclose(apart, apart[0], rtol=1e-9)
    assert apart[0] > 8


@pytest.mark.parametrize("actuator", [Ideal(), CRANE_DRIVE], ids=["ideal", "drive"])
def test_no_dot_hides_the_number_of_a_vector(actuator: Actuator) -> None:
    options = UnityBandOptions(half_width=0.05)
    made = design(CRANE, actuator, SHAPERS["num_si"], options)
    figure = Figure(figsize=(4.5, 3.6))
    axes = figure.add_axes((0.15, 0.1, 0.8, 0.8))
    draw_vectors(axes, made.impulses, CRANE, actuator)
    figure.canvas.draw()
    numbers = [
        axes.transData.transform(one.get_position())
        for one in axes.texts
        if one.get_text().isdigit()
    ]
    dots = [
        axes.transData.transform(point)
        for one in axes.lines
        if one.get_marker() == "o"
        for point in np.column_stack(one.get_data())
    ]
    assert len(numbers) == made.impulses.times_s.size
    assert dots
    radius = 9 * figure.dpi / 72  # of a number in its circle, and of a dot [px]
    assert min(np.hypot(*(one - dot)) for one in numbers for dot in dots) > radius


def test_a_chain_that_turns_slowly_is_a_polygon() -> None:
    turns = np.exp(0.05j * np.arange(100))
    assert not lie_on_one_another(turns)
    assert lie_on_one_another(np.cos(np.pi * np.arange(5)) + 0j)


def test_vectors_of_a_plane_are_drawn_in_it() -> None:
    figure, made, _ = _sheet("umzv", CRANE, CRANE_DRIVE)
    vectors = vibration_vectors(made.impulses, CRANE, CRANE_DRIVE)
    drawn = [complex(*head) - complex(*tail) for tail, head in _arrows(panel(figure, "vectors"))]
    np.testing.assert_allclose(drawn, vectors, atol=ROUNDING)


@pytest.mark.parametrize("plant", [THREE, SIX])
def test_of_many_impulses_each_time_is_written_or_counted(plant: Modes) -> None:
    figure, made = _sheet_of_modes("convolved", plant, Ideal())
    words = [text.get_text() for text in panel(figure, "impulses").texts]
    written = sum(word.startswith("$t_{") for word in words)
    left_out = sum(int(word.split()[0]) for word in words if word.endswith("without room"))
    assert written + left_out == made.impulses.times_s.size


UGLY: dict[str, tuple[str, Plant, Actuator]] = {
    **CASES,
    "lanes": ("zvd", CRANE, CRANE_DRIVE),
    "three modes": ("convolved", THREE, Ideal()),
    "six modes": ("convolved", SIX, Ideal()),
    "modes behind a drive": ("multi_umzv", TWO, CRANE_DRIVE),
    "a range": ("ei", PLANTS[2][0], CRANE_DRIVE),
    "limits": ("numzvd", CRANE, replace(RAMPS, then=EQUAL)),
}


@pytest.mark.parametrize("name", UGLY)
def test_no_text_meets_another_or_leaves_the_page(name: str) -> None:
    figure, _ = _sheet_of_modes(*UGLY[name])
    assert collisions(figure) == []
