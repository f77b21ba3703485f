"""Good files that the package does not have, made once: tables of a user, recordings, meshes."""

from __future__ import annotations

import io
import json
import multiprocessing
import tempfile
import zipfile
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

import numpy as np
from _fuzz_seeds import Seed

_HEAD = "# title: own\n# source: mine\n# obtained: by hand\n# conventions: as here\n"


def captive() -> Iterator[Seed]:
    """Measured captive tests in our form and in HMRI's."""
    rows = "speed [m/s],n [rev/s],beta [deg],delta [deg],X [-],Y [-],N [-]\n"
    rows += "1.0,9.9,0,0,-0.02,0.0,0.0\n1.0,9.9,5,10,-0.03,0.1,0.05\n"
    yield Seed("own", {"own.csv": (_HEAD + "# length: 6.893\n" + rows).encode()})
    hmri = "# captive tests in deep water at HMRI\nSpeed,rps,beta,delta,X',Y',N'\n"
    hmri += "1.179,9.9,4.0,0.0,-0.02,0.01,0.004\n1.179,9.9,6.0,5.0,-0.03,0.02,0.006\n"
    yield Seed("hmri", {"hmri.csv": hmri.encode()})


def samples() -> Iterator[Seed]:
    """A user's samples of propeller and rudder, as ``ship-gym fit-surrogate`` takes them."""
    titles = "point [-],J [-],beta [deg],K_T [-],10K_Q [-],K_S [-],C_Fx [-],C_Fy [-],set\n"
    rows = ""
    for k in range(12):
        J, beta = 0.4 + 0.05 * k, 2.0 * k
        rest = f"{0.4 - 0.3 * J:.4f},{0.5 - 0.3 * J:.4f},{0.01 + 0.001 * beta:.4f},-0.2,0.6"
        rows += f"{k + 1},{J:.3f},{beta},{rest},{'validation' if k % 6 == 5 else 'training'}\n"
    text = _HEAD + "# turn: starboard\n# delta_deg: 35\n" + titles + rows
    yield Seed("own", {"samples.csv": text.encode()})


def histories() -> Iterator[Seed]:
    """A measured time history of a zig-zag, of made-up numbers."""
    from ship_gym.reports.histories import _COLUMNS

    lines = ["# a free-running test", ",".join(_COLUMNS)]
    for k in range(60):
        t = 0.5 * k
        delta = 0.0 if t < 5.0 else min(10.0, 5.0 * (t - 5.0))
        psi = 0.0 if t < 6.0 else -0.5 * (t - 6.0)
        values = dict(zip(_COLUMNS, (t, 1.18 * t, 0.0, psi, 1.18, 0.01, delta), strict=True))
        lines.append(",".join(f"{values[name]:.4f}" for name in _COLUMNS))
    yield Seed("zigzag", {"marin_free_zz_10.csv": "\n".join(lines).encode()})


def trials() -> Iterator[Seed]:
    """Values of an earlier computation of all trials."""
    rows = "ship;trial;measure;computed [-];measured [-];unit\n"
    rows += "kcs_model;turning 35 deg;advance;3.1;3.0;L\nkcs_model;zigzag;overshoot;8.1;8.0;deg\n"
    yield Seed("trials", {"trials.csv": (_HEAD + rows).encode()})


def tracks() -> Iterator[Seed]:
    """GeoJSON in degrees and in metres, a line and points."""
    line = {"type": "LineString", "coordinates": [[8.0, 54.0], [8.1, 54.05], [8.2, 54.05]]}
    places = [[0.0, 0.0], [0.0, 4000.0], [3000.0, 8000.0]]
    points = [
        {"type": "Feature", "properties": {"units": "m"}, "geometry": _point(place)}
        for place in places
    ]
    metres = {"type": "LineString", "coordinates": [[0, 0], [0, 5000], [4000, 9000, 0]]}
    for name, data in {
        "degrees": {"type": "Feature", "properties": {}, "geometry": line},
        "bare": line,
        "points": {"type": "FeatureCollection", "features": points},
        "metres": {"type": "Feature", "properties": {"units": "m"}, "geometry": metres},
    }.items():
        yield Seed(name, {"track.geojson": json.dumps(data, indent=1).encode()})


def _point(place: list[float]) -> dict:
    return {"type": "Point", "coordinates": place}


def recordings() -> Iterator[Seed]:
    """A recording of a short run, made in a process of its own: rerun is not to be forked."""
    context = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(1, mp_context=context) as apart:
        yield Seed("run", {"run.rrd": apart.submit(_recorded, "run.rrd").result()})


def journals() -> Iterator[Seed]:
    """What a run left that was broken off."""
    yield Seed("run", {"run.rrd.partial": _recorded("run.rrd.partial")})


def _recorded(name: str) -> bytes:
    """A recording, or a journal with three chunks, of numbers that no ship has sailed."""
    from ship_gym.recording import Trajectory
    from ship_gym.recording.journal import Journal

    t = np.arange(0.0, 60.0, 2.0)
    columns = {"t": t, "x": 7.0 * t, "y": 0.1 * t, "psi": 0.001 * t, "u": np.full(len(t), 7.0)}
    meta = {"ship": {"name": "kcs"}, "seed": 1, "task": "heading_keeping", "metrics": {"rms": 1.0}}
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / name
        if name.endswith(".rrd"):
            Trajectory(columns, meta).to_rrd(path)
        else:
            journal = Journal(path, list(columns), meta)
            for part in np.array_split(np.stack(list(columns.values()), axis=1), 3):
                journal.append(part)
            journal.close()
        return path.read_bytes()


def old_policies() -> Iterator[Seed]:
    """A policy of version 0.1, made from one of today's."""
    rng = np.random.default_rng(0)
    sizes = (5, 8, 1)
    layers = {f"weight_{k}": rng.normal(size=(sizes[k + 1], sizes[k])) for k in range(2)}
    layers |= {f"bias_{k}": np.zeros(sizes[k + 1]) for k in range(2)}
    card = {
        "format": 1,
        "name": "old",
        "network": {"layers": 2, "activation": "tanh", "output": "clip"},
        "observations": ["a", "b", "c", "d", "e"],
        "decisions": ["rudder"],
    }
    scaling = {"mean": np.zeros(5), "scale": np.ones(5), "limit": np.float64(10.0)}
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w") as archive:
        archive.writestr("card.json", json.dumps(card))
        for name, arrays in (("actor.npz", layers), ("normaliser.npz", scaling)):
            inner = io.BytesIO()
            np.savez(inner, **arrays)
            archive.writestr(name, inner.getvalue())
    yield Seed("old", {"policy.zip": stream.getvalue()})


def run_cards() -> Iterator[Seed]:
    """The card of a run of training and the state of a checkpoint, as ``--resume`` reads them."""
    from ship_gym_agents.sb3.config import plain, run_config

    validation = {"samples": 1000, "success": 1.0, "return": -3.2, "rudder_travel": 1.5, "rms": 2.0}
    told = {"samples": 1000, "seconds": 3.0, "validations": [validation]}
    for algorithm in ("ppo", "sac"):
        card = {"name": algorithm, "status": "stopped", "config": plain(run_config(algorithm))}
        card |= {"budget": {"minutes": 1.0, "steps": None}, "used": 0.5, "best": validation, **told}
        card |= {"measure": {"name": "rms", "unit": "deg"}, "validation_seeds": [1000000, 1000007]}
        yield Seed(algorithm, {"card.json": json.dumps(card, indent=1).encode()})
    state = {"episodes": 8, "limit": None, "validated": 1.0, **told}
    yield Seed("state", {"state.json": json.dumps(state).encode()}, {"state": True})


def settings_files() -> Iterator[Seed]:
    """Settings and a unit of a benchmark, as a run that goes on reads them."""
    from _fuzz_use import SETTINGS

    unit = {"seconds": 1.0, "rows": [{"scenario": "heading_keeping", "ship": "kcs", "seed": 0}]}
    files = {
        "settings.json": json.dumps(SETTINGS).encode(),
        "units/00000.json": json.dumps(unit).encode(),
    }
    yield Seed("benchmark", files)


def references() -> Iterator[Seed]:
    """Reference values of the benchmark."""
    from ship_gym.evaluation.score import FILE

    data = json.loads(Path(FILE).read_text(encoding="utf-8"))
    data["cells"] = dict(list(data["cells"].items())[:3])
    yield Seed("shipbench", {"references.json": json.dumps(data, indent=1).encode()})


def results() -> Iterator[Seed]:
    """A table of a benchmark with few episodes."""
    from ship_gym.evaluation.episodes_table import Results, table_of, write_results
    from ship_gym.provenance import provenance

    rows = [
        {
            "suite": "core",
            "scenario": "heading_keeping",
            "ship": ship,
            "controller": "pid",
            "seed": k,
        }
        for ship in ("kcs", "onrt")
        for k in range(3)
    ]
    suite = {"version": 1, "title": "core", "sha256": "0", "scenarios": ["heading_keeping"]}
    about = {
        "suites": {"core": suite | {"controls": {}, "tasks": {}}},
        "seeds": [0, 1, 2],
        "ships": ["kcs", "onrt"],
        "controllers": {"pid": {}},
        "refused": [],
        "patience": 60.0,
        "computing_time": 1.5,
        "machine": {"processor": "none", "cores": 2},
        "command": "ship-gym benchmark",
        **provenance(),
    }
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "episodes.parquet"
        write_results(path, Results(table_of(rows), about))
        yield Seed("results", {"episodes.parquet": path.read_bytes()})


def manoeuvres() -> Iterator[Seed]:
    """A table of manoeuvres."""
    from ship_gym.evaluation.manoeuvres.table import COLUMNS, write_manoeuvres

    row = dict.fromkeys(COLUMNS) | {"ship": "kcs", "manoeuvre": "zigzag", "measure": "overshoot"}
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "manoeuvres.parquet"
        write_manoeuvres(path, [row | {"value": 8.1}], {"suite": "manoeuvres"})
        yield Seed("manoeuvres", {"manoeuvres.parquet": path.read_bytes()})


def curves() -> Iterator[Seed]:
    """The curve of a training."""
    text = "samples,seconds,rms\n1000,1.5,3.2\n2000,3.0,2.1\n3000,4.5,\n"
    yield Seed("curve", {"curve.csv": text.encode()})


def meshes() -> Iterator[Seed]:
    """A coarse hull of KCS as OBJ, STL in text and binary, GDF, OFF and PLY."""
    from ship_gym.seakeeping.hull_form import parametric_mesh
    from ship_gym.ships.loader import load_ship

    whole = parametric_mesh(load_ship("kcs"), 24, 6).both_sides()
    v, f = whole.vertices * [1.0, -1.0, -1.0], whole.panels
    points = "\n".join(" ".join(f"{x:.7g}" for x in row) for row in v)
    faces = "\n".join("4 " + " ".join(map(str, row)) for row in f.tolist())
    obj = "".join("v " + line + "\n" for line in points.split("\n"))
    obj += "".join("f " + " ".join(str(i + 1) for i in dict.fromkeys(r)) + "\n" for r in f.tolist())
    corners = "\n".join(" ".join(f"{x:.7g}" for x in row) for row in v[f].reshape(-1, 3))
    ply = f"ply\nformat ascii 1.0\nelement vertex {len(v)}\nproperty float x\nproperty float y\n"
    ply += f"property float z\nelement face {len(f)}\n"
    ply += "property list uchar int vertex_indices\nend_header\n"
    for name, text in {
        "hull.obj": obj,
        "hull.gdf": f"hull\n1.0 9.80665\n0 0\n{len(f)}\n{corners}\n",
        "hull.off": f"OFF\n{len(v)} {len(f)} 0\n{points}\n{faces}\n",
        "hull.ply": f"{ply}{points}\n{faces}\n",
        "hull.stl": _stl_text(v, f),
    }.items():
        yield Seed(name, {name: text.encode()})
    yield Seed("binary stl", {"hull.stl": _stl_binary(v, f)})


def _triangles(v: np.ndarray, f: np.ndarray) -> np.ndarray:
    triangles = np.concatenate([f[:, :3], f[:, [0, 2, 3]]])
    return v[triangles[triangles[:, 1] != triangles[:, 2]]]


def _stl_text(v: np.ndarray, f: np.ndarray) -> str:
    lines = ["solid hull"]
    for corners in _triangles(v, f):
        lines += ["facet normal 0 0 0", "outer loop"]
        lines += [f"vertex {x:.7g} {y:.7g} {z:.7g}" for x, y, z in corners]
        lines += ["endloop", "endfacet"]
    return "\n".join([*lines, "endsolid"]) + "\n"


def _stl_binary(v: np.ndarray, f: np.ndarray) -> bytes:
    corners = _triangles(v, f).astype("<f4")
    kind = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
    rows = np.zeros(len(corners), kind)
    rows["corners"] = corners
    return bytes(80) + np.uint32(len(rows)).tobytes() + rows.tobytes()
