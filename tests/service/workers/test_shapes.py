"""What requests share that are expected to cost alike."""

from service.workers.shapes import MAX_SHAPE_BYTES, shape_of


def test_work_that_differs_in_numbers_only_is_expected_to_cost_alike() -> None:
    bodies = [b'{"plant": {"cable_length_m": 0.8}}', b'{"plant": {"cable_length_m": -1.2e-3}}']
    one, other = (shape_of("design", body) for body in bodies)
    assert one == other
    assert one != shape_of("map", bodies[0])
    assert one != shape_of("design", bodies[0].replace(b"cable", b"other"))
    assert shape_of("design", b"1" * MAX_SHAPE_BYTES + b"22") == ("design", 15)
