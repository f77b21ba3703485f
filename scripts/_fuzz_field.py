"""Good files of the tools of marine people: routes, measured spectra, hulls, NMEA sentences."""

from __future__ import annotations

import io
import json
import tempfile
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from _fuzz_seeds import Seed

_RTZ = """<?xml version="1.0" encoding="UTF-8"?>
<route xmlns="http://www.cirm.org/RTZ/1/{minor}" version="1.{minor}">
  <routeInfo routeName="Kiel to Gedser" vesselName="Nobody"/>
  <waypoints>
    <defaultWaypoint radius="0.5">
      <leg starboardXTD="0.2" portsideXTD="0.1" geometryType="Loxodrome" speedMax="12"/>
    </defaultWaypoint>
    <waypoint id="7" revision="0" name="Kiel light">
      <position lat="54.5" lon="10.28"/>
    </waypoint>
    <waypoint id="3" revision="2" radius="1.0">
      <position lat="54.6" lon="11.0"/>
      <leg geometryType="Orthodrome" portsideXTD="1.5" speedMin="6"/>
      <extensions><extension manufacturer="A" name="b"/></extensions>
    </waypoint>
    <waypoint id="12" revision="0" name="Gedser">
      <position lat="54.45" lon="11.9"/>
      <leg geometryType="Loxodrome"/>
    </waypoint>
  </waypoints>
  <schedules><schedule id="1" name="s"><manual>
    <scheduleElement waypointId="7" etd="2020-01-01T00:00:00Z"/>
  </manual></schedule></schedules>
</route>
"""
_GPX = """<?xml version="1.0" encoding="UTF-8"?>
<gpx version="1.1" creator="x" xmlns="http://www.topografix.com/GPX/1/1">
  {body}
</gpx>
"""
_PLACES = ((54.5, 10.28), (54.6, 11.0), (54.45, 11.9))


def routes() -> Iterator[Seed]:
    """RTZ 1.0 to 1.2, GPX routes and tracks, GeoJSON with legs, cut lines and the antimeridian."""
    for minor in range(3):
        name = f"RTZ 1.{minor}"
        yield Seed(name, {"route.rtz": _RTZ.format(minor=minor).encode()})
    for kind, tag in (("rte", "rtept"), ("trkseg", "trkpt")):
        points = "".join(
            f'<{tag} lat="{lat}" lon="{lon}"><name>a</name></{tag}>' for lat, lon in _PLACES
        )
        body = f"<{kind}>{points}</{kind}>"
        body = body if kind == "rte" else f"<trk>{body}</trk>"
        yield Seed(f"GPX {kind}", {"route.gpx": _GPX.format(body=body).encode()})
    yield from _written_routes()
    yield from _lines()


def _written_routes() -> Iterator[Seed]:
    """As we write them: radius, limits, speeds and geometry in every format."""
    from ship_gym.tracks import Leg, Route, Waypoint, save_track

    waypoints = [Waypoint(*place, name="a", radius=900.0) for place in _PLACES]
    legs = [Leg("orthodrome", 300.0, 200.0, 3.0, 7.0), Leg("loxodrome", 300.0, 200.0)]
    ends = [Waypoint(*_PLACES[0]), waypoints[1], Waypoint(*_PLACES[2])]
    with tempfile.TemporaryDirectory() as folder:
        for suffix in (".rtz", ".gpx", ".geojson"):
            path = Path(folder) / f"route{suffix}"
            save_track(Route("own", tuple(ends), tuple(legs)), path)
            yield Seed(f"own{suffix}", {path.name: path.read_bytes()})


def _lines() -> Iterator[Seed]:
    a, b, c = ([lon, lat] for lat, lon in _PLACES)
    cut = [[[179.5, 10.0], [180.0, 10.1]], [[-180.0, 10.1], [-179.5, 10.2]]]
    for name, geometry in {
        "two lines": {"type": "MultiLineString", "coordinates": [[a, b], [b, c]]},
        "antimeridian, cut": {"type": "MultiLineString", "coordinates": cut},
        "beyond 180": {"type": "LineString", "coordinates": [[179.5, 10], [180.05, 10.1]]},
        "across": {"type": "LineString", "coordinates": [[179.5, 10], [-179.9, 10.1]]},
    }.items():
        line = {"type": "Feature", "properties": {"geometry": "orthodrome"}, "geometry": geometry}
        empty = {"type": "Feature", "properties": {}, "geometry": None}
        whole = {"type": "FeatureCollection", "features": [empty, line]}
        yield Seed(name, {"route.geojson": json.dumps(whole, indent=1).encode()})


# --- measured spectra ----------------------------------------------------------------------------


def spectra() -> Iterator[Seed]:
    """Tables of a buoy and of a hindcast, and netCDF 3 and 4 of two and of one dimension."""
    f = np.linspace(0.05, 0.3, 12)
    density = 20.0 * np.exp(-(((f - 0.1) / 0.03) ** 2))
    to = np.arange(15.0, 360.0, 30.0)
    both = density[:, None] * np.cos(np.radians(to - 75.0) / 2.0) ** 8 / 100.0
    buoy = "frequency [Hz],density [m2/Hz],direction_from [deg],spread [deg]\n"
    buoy += "".join(f"{x:.4f},{S:.6g},250,21\n" for x, S in zip(f, density, strict=True))
    yield Seed("buoy", {"buoy.csv": ("# a buoy\n" + buoy).encode()})
    table = "frequency [Hz],direction_from [deg],density [m2/Hz/deg]\n"
    for x, row in zip(f, both, strict=True):
        table += "".join(f"{x:.4f},{d},{S:.6g}\n" for d, S in zip(to, row, strict=True))
    yield Seed("hindcast", {"hindcast.csv": table.encode()})
    for engine in ("h5netcdf", "scipy"):
        yield Seed(f"two, {engine}", {"two.nc": _netcdf(engine, f, both, to)}, _FIRST)
        yield Seed(f"one, {engine}", {"one.nc": _netcdf(engine, f, density)}, _FIRST)


_FIRST = {"pick": "time=#0"}


def _netcdf(engine: str, f: np.ndarray, density: np.ndarray, to: np.ndarray | None = None) -> bytes:
    import xarray

    times = np.array(["2020-02-01T00", "2020-02-01T06"], dtype="datetime64[ns]")
    coords = {"frequency": ("frequency", f, {"units": "Hz"}), "time": times}
    both = np.stack([density, 2.0 * density])
    if to is None:
        dims, around = ("time", "frequency"), np.full(both.shape, 250.0)
        variables = {
            "spectral_wave_density": (dims, both, {"units": "m2/Hz"}),
            "mean_wave_dir": (dims, around, {"units": "degrees_true"}),
            "wave_spectrum_r1": (dims, np.full(both.shape, 0.8)),
        }
    else:
        way = {"units": "degree", "standard_name": "sea_surface_wave_to_direction"}
        coords["direction"] = ("direction", to, way)
        dims = ("time", "frequency", "direction")
        variables = {"efth": (dims, both, {"units": "m2 s rad-1"})}
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "a.nc"
        xarray.Dataset(variables, coords).to_netcdf(path, engine=engine)
        return path.read_bytes()


# --- hulls ---------------------------------------------------------------------------------------


def hulls() -> Iterator[Seed]:
    """A coarse hull of KCS for Nemoh, HydroStar, HAMS, one side or both; for Gmsh and VTK."""
    from ship_gym.seakeeping.hull_form import parametric_mesh
    from ship_gym.ships.loader import load_ship

    half = parametric_mesh(load_ship("kcs"), 24, 6)
    for one, mesh in ((0, half.both_sides()), (1, half)):
        v, f = mesh.vertices * [1.0, -1.0, -1.0], mesh.panels
        nodes = [f"{i} " + " ".join(f"{x:.7g}" for x in row) for i, row in enumerate(v, 1)]
        faces = [" ".join(map(str, row)) for row in (f + 1).tolist()]
        mar = [f"2 {one}", *nodes, "0 0. 0. 0.", *faces, "0 0 0 0"]
        hst = ["PROJECT: a hull", "", f"SYMMETRY {one}", "COORDINATES", *nodes, "ENDCOORDINATES"]
        hst += ["PANEL TYPE 0", *faces, "ENDPANEL", "ENDFILE"]
        pnl = ["    --Hull Mesh File--", "", "    # Number of Panels, Nodes"]
        pnl += [f"{len(f)} {len(v)} 0 {one}", "", "    # Start Definition of Node", *nodes]
        pnl += ["   end", "", "    # Start of Connectivity"]
        pnl += [f"{i} 4 {row}" for i, row in enumerate(faces, 1)] + ["   end"]
        for suffix, lines in (("mar", mar), ("dat", mar), ("hst", hst), ("pnl", pnl)):
            name = f"hull.{suffix}"
            yield Seed(f"{name}, one side: {bool(one)}", {name: "\n".join(lines).encode()})
    whole = half.both_sides()
    yield from _meshio(whole.vertices * [1.0, -1.0, -1.0], whole.panels)


def _meshio(v: np.ndarray, f: np.ndarray) -> Iterator[Seed]:
    import meshio

    four = np.array([len(set(row)) == 4 for row in f.tolist()])
    three = np.array([list(dict.fromkeys(row)) for row in f[~four].tolist()]).reshape(-1, 3)
    mesh = meshio.Mesh(v, [("quad", f[four]), *([("triangle", three)] if len(three) else [])])
    with tempfile.TemporaryDirectory() as folder:
        for name, kind, options in (
            ("hull.msh", "gmsh22", {"binary": False}),
            ("hull.vtk", "vtk", {"binary": False}),
            ("hull.vtu", "vtu", {"binary": False}),
        ):
            path = Path(folder) / name
            meshio.write(path, mesh, file_format=kind, **options)
            yield Seed(name, {name: path.read_bytes()})


# --- sentences -----------------------------------------------------------------------------------


def sentences() -> Iterator[Seed]:
    """Lines as an autopilot, a chart plotter and instruments send them."""
    bodies = [
        "AGHTC,V,5.0,R,R,,,,,,,,,T",
        "AGHSC,045.0,T,,M",
        "AGROR,-7.5,A,,V,B",
        "GPAPB,A,A,0.10,R,N,V,V,011,M,DEST,011,M,011,T",
        "HEHDT,274.1,T",
        "GPRMC,123519,A,4807.038,N,01131.000,E,022.4,084.4,230394,003.1,W",
        "IIMWV,84.0,R,10.4,N,A",
        "PGRME,15.0,M,45.0,M,25.0,M",
    ]
    stream = io.BytesIO()
    for body in bodies:
        stream.write(nmea_line(body.encode()))
    yield Seed("all", {"lines.nmea": stream.getvalue()})
    for body in bodies[:4]:
        yield Seed(body[2:5], {"lines.nmea": nmea_line(body.encode()) * 3})


def nmea_line(body: bytes) -> bytes:
    """A sentence with its checksum and line end."""
    total = 0
    for byte in body:
        total ^= byte
    return b"$" + body + b"*%02X\r\n" % total
