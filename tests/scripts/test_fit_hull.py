"""ship-gym fit-hull: files it writes, and one-line refusals."""

from __future__ import annotations

import json
import math

import pytest

from ship_gym.captive import measure, programme
from ship_gym.ships import load_ship

HEAD = "# title: own\n# source: me\n# obtained: computed\n# conventions: as here\n"


@pytest.fixture(scope="module")
def drift(tmp_path_factory):
    """A drift test of the ship herself."""
    path, ship = tmp_path_factory.mktemp("runs") / "drift.csv", load_ship("kvlcc2_model")
    runs = programme(ship, "drift")
    lines = [f"{HEAD}speed [m/s],n [rev/s],beta [deg],X [-],Y [-],N [-]"]
    for run, row in zip(runs, measure(ship, runs), strict=True):
        cells = run.speed, run.n, math.degrees(run.beta), row["X"], row["Y"], row["N"]
        lines.append(",".join(map(repr, cells)))
    path.write_text("\n".join(lines) + "\n")
    return path


def test_a_fit_writes_ship_page_and_picture(cli, drift, tmp_path):
    out, page, plot = tmp_path / "ship.toml", tmp_path / "fit.md", tmp_path / "fit.png"
    words = ["--captive", drift, "--numbers", "Y_v", "Y_vvv", "N_v"]
    files = ["--out", out, "--page", page, "--plot", plot]
    code, text, _ = cli("fit-hull", *map(str, [*words, *files]), "--json")
    data = json.loads(text)
    ship = load_ship("kvlcc2_model")
    assert code == 0 and data["files"] == [str(out), str(page), str(plot)]
    assert [x["name"] for x in data["numbers"]] == ["hull.Y_v", "hull.Y_vvv", "hull.N_v"]
    assert data["numbers"][0]["value"] == pytest.approx(ship.hull.Y_v, rel=1e-6)
    assert "drift.csv" in out.read_text() and "standard error" in load_ship(out).sources["hull.N_v"]
    assert "| Y_v |" in page.read_text() and plot.read_bytes().startswith(b"\x89PNG")
    # the same again is the same result; another ship's is not
    assert cli("fit-hull", *map(str, [*words, "--out", out]))[0] == 0
    code, _, told = cli("fit-hull", "--ship", "kcs_model", *map(str, [*words, "--out", out]))
    assert code == 2 and "holds a ship fitted from kvlcc2_model" in told


@pytest.mark.parametrize(
    ("words", "told"),
    [
        ([], "--captive or --records: needs one of them"),
        (["--numbers", "Y_q"], "Y_q"),
        (["--numbers", "Y_r"], "no test tells hull.Y_r"),
        (["--ship", "kvlcc3"], "kvlcc3"),
        (["--records", "a.csv"], "--captive or --records: needs one of them"),
        (["--hold-out", "a.csv"], "--hold-out: belongs to --records"),
    ],
)
def test_refusals_are_one_line(cli, drift, tmp_path, words, told):
    given = ["--captive", str(drift)] if words else []
    code, _, text = cli("fit-hull", *given, *words, "--out", str(tmp_path / "ship.toml"))
    assert code == 2 and told in text and text.count("\n") == 1 and len(text) <= 301
    assert not list(tmp_path.iterdir())


def test_a_calibration_names_records_and_what_was_held_out(cli, tmp_path):
    from ship_gym.manoeuvres import zigzag

    files = []
    for side in (1.0, -1.0):
        angle = math.radians(side * 20.0)
        c = zigzag(load_ship("kvlcc2_model"), angle, angle, overshoots=1).trajectory.columns
        names = ("t", "x", "y", "psi", "delta", "n")
        scale = {"psi": math.degrees(1.0), "delta": math.degrees(1.0)}
        table = zip(*((c[k] * scale.get(k, 1.0)).tolist() for k in names), strict=True)
        titles = "t [s],x [m],y [m],psi [deg],delta [deg],n [rev/s]"
        files.append(tmp_path / f"{side:.0f}.csv")
        files[-1].write_text("\n".join([HEAD + titles, *(",".join(map(repr, r)) for r in table)]))
    out = tmp_path / "ship.toml"
    words = ["--records", files[0], "--hold-out", files[1], "--numbers", "N_v", "--out", out]
    code, text, _ = cli("fit-hull", *map(str, words), "--json")
    data = json.loads(text)
    assert code == 0 and [r["held_out"] for r in data["records"]] == [False, True]
    ship = load_ship("kvlcc2_model")
    # the rudder moves from the first row on, so that the motion at the start is not quite at rest
    assert data["numbers"][0]["value"] == pytest.approx(ship.hull.N_v, rel=0.05)
    head = out.read_text()
    assert "calibrated to free-running records: 1.csv" in head and "Held out: -1.csv" in head
    assert load_ship(out).hull.N_v == pytest.approx(data["numbers"][0]["value"], rel=1e-4)
    code, _, told = cli("fit-hull", "--records", str(files[0]))
    assert code == 2 and "needs the --numbers" in told
