"""Answers have arrays, pictures and tables."""

import pickle
from typing import Any, Literal

import numpy as np
import pytest
from matplotlib.figure import Figure

import shapersmith
from service.cli.rendering import MAX_HTML_ROWS
from shapersmith.here import HERE
from tests.conftest import CRANE
from tests.shapersmith.requests import LENGTHS, REQUESTS, call

FREQUENCY = "natural_frequency_rad_s"
LAG = shapersmith.FirstOrder(accel_time_constant_s=0.1, decel_time_constant_s=0.05)


@pytest.mark.parametrize("operation", REQUESTS)
def test_a_picture_is_that_of_the_request(operation: str) -> None:
    figure = call(HERE, operation)(**REQUESTS[operation]).plot()
    assert isinstance(figure, Figure)
    assert figure.axes


def test_a_search_that_was_watched_is_drawn_as_one() -> None:
    searched, designed = (
        shapersmith.design(**CRANE, trace=trace).plot() for trace in (True, False)
    )
    assert len(searched.axes) != len(designed.axes)


@pytest.mark.parametrize("operation", REQUESTS)
def test_a_notebook_shows_a_small_table(operation: str) -> None:
    shown = call(HERE, operation)(**REQUESTS[operation])._repr_html_()
    assert shown.startswith("<table><tr><th>")
    assert 1 < shown.count("<tr>") <= MAX_HTML_ROWS + 1
    assert shown.count("<td>") > 1


def test_a_motion_is_printed_by_its_beginning_and_end() -> None:
    played = shapersmith.simulate(
        CRANE["plant"], {"kind": "ideal"}, shapersmith.StepCommand(), points=500
    )
    times_s = [f"{time_s:.9g}" for time_s in played.times_s]
    printed = str(played).splitlines()
    shown = [line.split()[0] for line in printed[1:17]]
    assert shown == [*times_s[:10], "…", *times_s[-5:]]
    assert printed[17].startswith("485 rows are not shown")


def test_a_notebook_shows_a_picture_without_more() -> None:
    figure = shapersmith.design(**CRANE).plot()
    assert getattr(figure, "_repr_png_")().startswith(b"\x89PNG")  # noqa: B009


def test_a_long_table_is_cut_and_its_findings_are_kept() -> None:
    played = shapersmith.simulate(
        CRANE["plant"], {"kind": "ideal"}, shapersmith.StepCommand(), points=500
    )
    shown = played._repr_html_()
    assert shown.count("<tr>") == MAX_HTML_ROWS + 1
    assert "…" in shown
    assert "residual    100 % of an unshaped step" in shown


def test_texts_are_escaped_for_a_notebook() -> None:
    shown = shapersmith.design(**CRANE)._repr_html_()
    assert "residual 1" in shown
    assert "&lt;= 1e-09" in shown


def test_an_answer_is_printed_as_the_command_line_prints_it() -> None:
    lines = str(shapersmith.design(**CRANE)).splitlines()
    assert lines[0].split() == ["impulse", "time_s", "amplitude"]
    assert any(line.startswith("certificate verified") for line in lines)


def test_steps_are_arrays() -> None:
    found = shapersmith.design(**CRANE)
    assert found.times_s.dtype == found.amplitudes.dtype == np.float64
    assert found.amplitudes.sum() == pytest.approx(1.0)
    move = shapersmith.maneuver(**CRANE, speed_m_s=0.2, distance_m=0.6)
    assert move.times_s.tolist() == move.command.times_s
    assert move.amplitudes.sum() == pytest.approx(0.0)


def test_the_motion_is_arrays_by_name() -> None:
    played = shapersmith.simulate(
        CRANE["plant"], {"kind": "ideal"}, shapersmith.StepCommand(), points=5
    )
    shapes = {name: values.shape for name, values in played.history.items()}
    assert set(shapes.values()) == {(5,)}
    assert "angle_rad" in shapes
    mode = shapersmith.Mode(natural_frequency_rad_s=3.5)
    of_mode = shapersmith.simulate(mode, shapersmith.Ideal(), shapersmith.StepCommand())
    assert "angle_rad" not in of_mode.history


def test_a_map_is_an_array_of_its_quantity_with_nan_where_there_is_none() -> None:
    dampings = {"field": "/plant/damping_ratio", "values": [0, 0.9]}
    crane, drive = CRANE["plant"], {"kind": "ideal"}
    curve = shapersmith.field_map(crane, drive, LENGTHS, shaper="zv")
    table = shapersmith.field_map(crane, drive, LENGTHS, dampings, shaper="zv")
    assert (curve.values.shape, table.values.shape) == ((3,), (2, 3))
    assert table.values[0].tolist() == curve.values.tolist()
    times = [
        shapersmith.field_map(
            *(crane, drive, dampings, y), shaper="um_ei", quantity="times_s", design="each"
        ).values
        for y in (None, LENGTHS)
    ]
    count = shapersmith.design(crane, drive, "um_ei").times_s.size
    assert [values.shape for values in times] == [(2, count), (3, 2, count)]
    assert np.isnan(times[0][1]).all()  # there is no such shaper of a load so damped
    assert np.isnan(times[1][:, 1]).all()
    assert np.diff(times[1][:, 0], axis=0).min() >= 0.0  # a longer cable takes longer


def test_an_answer_is_pickled_with_its_picture() -> None:
    found = shapersmith.design(**CRANE)
    again = pickle.loads(pickle.dumps(found))
    assert again == found
    assert isinstance(again.plot(), Figure)


FITS = [
    (shapersmith.Pendulum(cable_length_m=0.8), "/plant/cable_length_m", 0.5, 1.2, "dimensionless"),
    (shapersmith.Mode(natural_frequency_rad_s=3.5), f"/plant/{FREQUENCY}", 2, 4, "dimensionless"),
    (
        shapersmith.Mode(natural_frequency_rad_s=3.5),
        f"/plant/{FREQUENCY}",
        2,
        4,
        "time_in_frequency",
    ),
    (
        shapersmith.Mode(natural_frequency_rad_s=3.5),
        "/plant/damping_ratio",
        0,
        0.2,
        "dimensionless",
    ),
]


@pytest.mark.parametrize(("plant", "over", "start", "stop", "form"), FITS)
@pytest.mark.parametrize("drive", [shapersmith.Ideal(), LAG])
def test_fitted_curves_give_times_at_any_value(
    plant: shapersmith.Pendulum | shapersmith.Mode,
    drive: shapersmith.Ideal | shapersmith.FirstOrder,
    over: str,
    start: float,
    stop: float,
    form: Literal["dimensionless", "time_in_frequency"],
) -> None:
    field = shapersmith.FitRange(over=over, from_=start, to=stop, degree=5, form=form)
    fitted = shapersmith.fit(plant, drive, "numzv", field)
    values = [start, 0.3 * start + 0.7 * stop, stop]
    one_by_one = [fitted.times_s(value) for value in values]
    np.testing.assert_allclose(fitted.times_s(np.array(values)), one_by_one, rtol=1e-13)
    for value in values:
        there: dict[str, Any] = {**plant.model_dump(), over.rpartition("/")[2]: value}
        exact = shapersmith.design(there, drive, "numzv", sensitivity=None).times_s
        error = np.abs(fitted.times_s(value) - exact).max()
        assert error <= 1.1 * fitted.worst_timing_error_s + 1e-12


def test_fitted_curves_give_no_times_outside_their_range() -> None:
    crane = shapersmith.Pendulum(cable_length_m=0.8)
    lengths = shapersmith.FitRange(over="/plant/cable_length_m", from_=0.5, to=1.2, degree=3)
    fitted = shapersmith.fit(crane, LAG, "numzv", lengths)
    with pytest.raises(shapersmith.InvalidInputError, match=r"between 0.5 and 1.2"):
        fitted.times_s(3.0)
