"""A table on samples over HTTP: its job, and the files of its result."""

from typing import Any

import httpx

from tests.service.cli.test_sampled_tables import SPEC
from tests.service.http.test_tables_over_http import ended


def test_a_table_on_samples_is_a_job_like_any(client: httpx.Client) -> None:
    begun = client.post("/v1/tables", json=SPEC)
    assert begun.status_code == 202, begun.text
    location = begun.headers["location"]
    job = ended(client, location)
    assert (job["rows_done"], job["verified"]) == (4, 4)
    table: dict[str, Any] = client.get(f"{location}/result", params={"format": "json"}).json()
    names = [name for name, _, _ in table["columns"]]
    widest = table["impulses"]
    assert names.index("a1") - names.index("t1_s") == widest
    for row in table["rows"]:
        held = dict(zip(names, row, strict=True))
        shaper = {"kind": "umzv", "sample_time_s": held["shaper.sample_time_s"]}
        plant = {
            **SPEC["design"]["plant"],
            "natural_frequency_rad_s": held["plant.natural_frequency_rad_s"],
        }
        asked = {**SPEC["design"], "shaper": shaper, "plant": plant}
        design = client.post("/v1/designs", json=asked).json()
        times = [held[f"t{number}_s"] for number in range(1, widest + 1)]
        wanted = design["shaper"]["impulses"]["times_s"]
        assert times == [*wanted, *[None] * (widest - len(wanted))]
        assert held["residual"] == design["residual"]
    text = client.get(f"{location}/result", params={"format": "c"}).text
    assert "Between two rows nothing is verified" in text
    refused = client.get(f"{location}/result", params={"format": "klipper"})
    assert refused.status_code == 422


def test_a_fit_of_a_table_on_samples_is_refused(client: httpx.Client) -> None:
    fit = {"over": "/plant/natural_frequency_rad_s", "from": 10, "to": 14, "degree": 3}
    answer = client.post("/v1/tables", json={**SPEC, "fit": fit})
    assert answer.status_code == 422
    (error,) = answer.json()["errors"]
    assert error["pointer"] == "/design/shaper/sample_time_s"
    assert "take the nearest row" in error["detail"]
