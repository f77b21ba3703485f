"""Files of spectra as buoys and hindcasts write them: names, units, directions, several of them."""

import math

import numpy as np
import pytest

from ship_gym.config import ConfigError
from ship_gym.sea import hdf5_child, read_spectrum, spectrum_netcdf
from ship_gym.sea.netcdf_values import density_factor
from ship_gym.sea.spectra import jonswap, spreading

xarray = pytest.importorskip("xarray")
pytest.importorskip("h5netcdf")

F = np.linspace(0.04, 0.4, 30)
DEG = np.arange(7.5, 360.0, 15.0)
S = 2.0 * np.pi * jonswap(2.0 * np.pi * F, 3.0, 9.0)
M_0 = np.trapezoid(S, F)
FROM = 250.0  # waves come from there, so go to 70 deg
TO = 70.0


@pytest.fixture(autouse=True)
def read_here(monkeypatch):
    """Files are read by this process, which is faster, but where a test says otherwise."""
    monkeypatch.setattr(spectrum_netcdf, "can_read_apart", lambda: False)


def over(centre, axis=DEG):
    """Density [m2/Hz/rad] about a direction of the axis, of the same m_0."""
    off = np.radians(axis - centre + 180.0) % (2.0 * np.pi) - np.pi
    D = spreading(off, 3.0)
    return S[:, None] * D / (D.sum() * np.radians(15.0))


def saved(tmp_path, variables, coords, engine="h5netcdf", name="a.nc"):
    path = tmp_path / name
    xarray.Dataset(variables, coords).to_netcdf(path, engine=engine)
    return path


def axis(name, values, **attributes):
    return (name, values, attributes)


HERTZ = axis("frequency", F, units="s-1", standard_name="sea_surface_wave_frequency")
VARIANCE = "sea_surface_wave_directional_variance_spectral_density"
TIMES = np.array(["2020-02-01T00", "2020-02-01T06", "2020-02-01T12"], dtype="datetime64[ns]")


def ww3(tmp_path, engine="h5netcdf", **changes):
    """As WAVEWATCH III: where waves go to, per radian, times and stations; the second is higher."""
    both = np.stack([over(TO), 4.0 * over(TO)])[None] * np.array([1.0, 0.25, 0.5])[:, None, None,
                                                                                  None]  # fmt: skip
    attributes = {"units": "m2 s rad-1", "standard_name": VARIANCE}
    way = {"units": "degree", "standard_name": "sea_surface_wave_to_direction"} | changes
    return saved(
        tmp_path,
        {"efth": (("time", "station", "frequency", "direction"), both, attributes)},
        {"frequency": HERTZ, "direction": axis("direction", DEG, **way), "time": TIMES},
        engine,
    )


def check(spectrum, m_0=M_0, directional=True):
    assert spectrum.m_0 == pytest.approx(m_0, rel=1e-9)
    if directional:
        assert math.degrees(spectrum.mean_direction) == pytest.approx(TO, abs=0.1)
        wanted = math.degrees(math.sqrt(2.0 * (1.0 - _r_1())))
        assert math.degrees(spectrum.spread) == pytest.approx(wanted, abs=0.5)


def _r_1():
    theta = np.linspace(-0.5 * np.pi, 0.5 * np.pi, 20_001)
    return np.trapezoid(spreading(theta, 3.0) * np.cos(theta), theta)


@pytest.mark.parametrize("engine", ["h5netcdf", "scipy"])
def test_wavewatch_with_times_and_stations(tmp_path, engine):
    path = ww3(tmp_path, engine)
    check(read_spectrum(path, "time=2020-02-01T00:20, station=#0"))
    check(read_spectrum(path, "station=#1, time=2020-02-01T07"))
    check(read_spectrum(path, "time=#2, station=#1"), 2.0 * M_0)


def test_the_argument_overrules_what_a_file_says(tmp_path):
    path = ww3(tmp_path, standard_name="direction")
    check(read_spectrum(path, "time=#0, station=#0", "to"))
    turned = read_spectrum(path, "time=#0, station=#0", "from")
    assert math.degrees(turned.mean_direction) == pytest.approx(TO - 180.0, abs=0.1)


def test_swan_in_radians_and_wavespectra_per_degree(tmp_path):
    name = {"standard_name": "sea_surface_wave_from_direction"}
    swan = saved(
        tmp_path,
        {"density": (("frequency", "direction"), over(FROM), {"units": "m2/Hz/rad"})},
        {"frequency": axis("frequency", F, units="Hz"),
         "direction": axis("direction", np.radians(DEG), units="radians", **name)},
    )  # fmt: skip
    check(read_spectrum(swan))
    other = saved(
        tmp_path,
        {"efth": (("dir", "freq"), over(FROM).T[::-1] * math.pi / 180.0,
                  {"units": "m^{2}.s.degree^{-1}"})},
        {"freq": axis("freq", F, units="Hz"),
         "dir": axis("dir", DEG[::-1], units="degree", **name)},
        name="b.nc",
    )  # fmt: skip
    check(read_spectrum(other))


def era5():
    """Logarithms of density (30, 24) as ERA5 keeps it, its sum over directions, frequencies."""
    f = 0.03453 * 1.1 ** np.arange(30)
    density = np.stack([np.interp(f, F, column, 0.0, 0.0) for column in over(TO).T], axis=1)
    with np.errstate(divide="ignore"):
        logs = np.where(density > 0.0, np.log10(density), np.nan)
    return logs, density.sum(axis=1) * np.radians(15.0), f


def test_era5_numbers_its_bins_and_keeps_logarithms(tmp_path):
    logs, variances, f = era5()
    path = saved(
        tmp_path,
        {"d2fd": (("time", "latitude", "longitude", "direction", "frequency"),
                  logs.T[None, None, None], {"units": "m**2 s radian**-1"})},
        {"direction": np.arange(1, 25), "frequency": np.arange(1, 31), "time": TIMES[:1]},
    )  # fmt: skip
    check(read_spectrum(path), np.trapezoid(variances, f))


def test_era5_as_the_data_store_names_its_dimensions_now(tmp_path):
    """wavespectra's reader of ERA5 knows both pairs of names."""
    logs, variances, f = era5()
    path = saved(
        tmp_path,
        {"d2fd": (("valid_time", "directionNumber", "frequencyNumber"), logs.T[None])},
        {"directionNumber": np.arange(1.0, 25.0), "frequencyNumber": np.arange(1.0, 31.0),
         "valid_time": TIMES[:1]},
    )  # fmt: skip
    check(read_spectrum(path), np.trapezoid(variances, f))


R_1 = 0.8


@pytest.mark.parametrize(
    ("direction", "r_1", "words"),
    [
        (999.0, 0.8, r"mean_wave_dir\[0\] = 999 deg: allowed is -360 to 360"),
        (250.0, 80.0, r"wave_spectrum_r1\[0\] = 80: allowed is 0 to 1"),
    ],
)
def test_a_buoy_with_numbers_that_stand_for_missing_or_hundredfold(tmp_path, direction, r_1, words):
    path = saved(
        tmp_path,
        {"spectral_wave_density": (("frequency",), S, {"units": "m2/Hz"}),
         "mean_wave_dir": (("frequency",), np.full(len(F), direction), {"units": "degrees_true"}),
         "wave_spectrum_r1": (("frequency",), np.full(len(F), r_1))},
        {"frequency": axis("frequency", F, units="Hz")},
    )  # fmt: skip
    with pytest.raises(ConfigError, match=words):
        read_spectrum(path)


def test_ndbc_and_cdip_buoys(tmp_path):
    dims = ("time", "frequency", "latitude", "longitude")
    shape = (1, len(F), 1, 1)
    direction = np.where(S < 1e-9, np.nan, FROM)
    ndbc = saved(
        tmp_path,
        {"spectral_wave_density": (dims, S.reshape(shape), {"units": "(meter * meter)/Hz"}),
         "mean_wave_dir": (dims, direction.reshape(shape), {"units": "degrees_true"}),
         "wave_spectrum_r1": (dims, np.full(shape, R_1))},
        {"frequency": axis("frequency", F, units="Hz"), "time": TIMES[:1]},
    )  # fmt: skip
    cdip = saved(
        tmp_path,
        {"waveEnergyDensity": (("waveTime", "waveFrequency"), np.stack([S, 2.0 * S]),
                               {"units": "meter^2 second"}),
         "waveMeanDirection": (("waveTime", "waveFrequency"), np.full((2, len(F)), FROM),
                               {"units": "degreeT"}),
         "waveA1Value": (("waveTime", "waveFrequency"), np.full((2, len(F)), 0.6 * R_1)),
         "waveB1Value": (("waveTime", "waveFrequency"), np.full((2, len(F)), 0.8 * R_1))},
        {"waveFrequency": axis("waveFrequency", F, units="hertz"), "waveTime": TIMES[:2]},
        name="b.nc",
    )  # fmt: skip
    for spectrum in (read_spectrum(ndbc), read_spectrum(cdip, "waveTime=#0")):
        assert spectrum.m_0 == pytest.approx(M_0, rel=1e-9)
        assert math.degrees(spectrum.mean_direction) == pytest.approx(TO, abs=1e-6)
        assert spectrum.spread == pytest.approx(math.sqrt(2.0 * (1.0 - R_1)), rel=1e-6)


@pytest.mark.parametrize(
    ("units", "two", "factor"),
    [
        ("m2 s", False, 1.0), ("m^2/Hz", False, 1.0), ("(meter * meter)/Hz", False, 1.0),
        ("meter^2 second", False, 1.0), ("m2 s rad-1", False, 2.0 * math.pi),
        ("m2/(rad/s)", False, 2.0 * math.pi), ("m2 s rad-1", True, 1.0),
        ("m**2 s radian**-1", True, 1.0), ("m2/Hz/degr", True, 180.0 / math.pi),
        ("m^{2}.s.degree^{-1}", True, 180.0 / math.pi), ("m2 s", True, None), ("m s", False, None),
        ("J/m2/Hz", False, None), ("m2/s", False, None), ("m2 s deg-1", False, None),
        ("cm2/Hz", False, None), (None, False, None),
    ],
)  # fmt: skip
def test_units_of_a_density(units, two, factor):
    found = density_factor(units, two)
    assert found == (None if factor is None else pytest.approx(factor))


def csv(tmp_path, text, name="a.csv"):
    path = tmp_path / name
    path.write_text(text)
    return path


def rows(*columns):
    lines = zip(*columns, strict=True)
    return "".join(",".join(f"{float(x)!r}" for x in line) + "\n" for line in lines)


def test_csv_of_one_dimension(tmp_path):
    check(read_spectrum(csv(tmp_path, "frequency [Hz],density [m2/Hz]\n" + rows(F, S))), M_0, False)
    for unit in ("m^2/Hz", "m²/Hz"):
        text = f"frequency [Hz],density [{unit}]\n" + rows(F, S)
        check(read_spectrum(csv(tmp_path, text)), M_0, False)
    text = "frequency [rad/s],density [m2 s/rad]\n" + rows(2.0 * np.pi * F, S / (2.0 * np.pi))
    check(read_spectrum(csv(tmp_path, text)), M_0, False)
    spread = math.degrees(math.sqrt(2.0 * (1.0 - R_1)))
    flat = np.ones(len(F))
    head = "# a buoy\nfrequency [Hz],density [m2/Hz],"
    unit = R_1 * math.cos(math.radians(FROM)), R_1 * math.sin(math.radians(FROM))
    for text in (
        head + "direction_from [deg],spread [deg]\n" + rows(F, S, FROM * flat, spread * flat),
        head + "direction_to [deg],r1 [-]\n" + rows(F, S, TO * flat, R_1 * flat),
        head + "a1_from [-],b1_from [-]\n" + rows(F, S, unit[0] * flat, unit[1] * flat),
    ):
        spectrum = read_spectrum(csv(tmp_path, text))
        assert spectrum.m_0 == pytest.approx(M_0, rel=1e-12)
        assert math.degrees(spectrum.mean_direction) == pytest.approx(TO, abs=1e-6)
        assert spectrum.spread == pytest.approx(math.sqrt(2.0 * (1.0 - R_1)), rel=1e-6)


def test_csv_of_two_dimensions(tmp_path):
    f, deg = (grid.ravel() for grid in np.meshgrid(F, DEG, indexing="ij"))
    way = "frequency [Hz],direction_from [deg],density "
    per_rad = way + "[m2/Hz/rad]\n" + rows(f, deg, over(FROM).ravel())
    per_deg = way + "[m2/Hz/deg]\n" + rows(f, deg, over(FROM).ravel() * math.pi / 180.0)
    for text in (per_rad, per_deg):
        check(read_spectrum(csv(tmp_path, text)))


HEAD = "frequency [Hz],density [m2/Hz]\n"


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("frequency,density [m2/Hz]\n0.1,1\n", r"column 'frequency': allowed units are \[Hz\]"),
        ("frequency [Hz],density [m2]\n0.1,1\n", r"\[m2/Hz/deg\]"),
        ("freq [Hz],density [m2/Hz]\n0.1,1\n", "did you mean 'frequency'"),
        ("density [m2/Hz]\n1\n", "no column 'frequency'"),
        (HEAD + "0.1,1\n0.2,x\n0.3,1\n", r"a.csv:3: density \[m2/Hz\] = 'x' is not a number"),
        (HEAD + "0.1,1\n0.2,-1\n0.3,1\n", r"a.csv:3: density \[m2/Hz\] = -1.0: allowed is 0"),
        (HEAD + "0.1,1\n0.3,1\n0.2,1\n", "a.csv:4: frequency 0.2 Hz after 0.3 Hz"),
        (HEAD + "0.1,1\n0.2,1\n", "2 frequencies: allowed are 3"),
        (HEAD + "0.1,0\n0.2,0\n0.3,0\n", "no energy"),
        (HEAD.strip() + ",spread [deg]\n0.1,1,9\n", "'spread' without"),
        (HEAD.strip() + ",direction_to [deg]\n0.1,1,9\n", "without 'spread"),
        (HEAD.strip() + ",direction_to [deg],spread [deg]\n0.1,1,9,99\n",
         r"a.csv:2: spread \[deg\] = 99.0: allowed is 0"),
        (HEAD.strip() + ",direction_from [deg],spread [deg]\n0.1,1,999,9\n",
         r"a.csv:2: direction_from \[deg\] = 999.0: allowed is -360 to 360"),
        ("frequency [Hz],density [m2/Hz/rad],direction_to [deg]\n0.1,1,400\n",
         "a.csv:2: direction_to"),
        (HEAD.strip() + ",a1_to [-],b1_to [-]\n0.1,1,0.9,-0.9\n",
         "a.csv:2: a1, b1 have the length 1.27"),
        (HEAD.replace(",", ";") + "0.1;1\n", "a.csv:1: cells are parted by ';'"),
        ("frequency [Hz],density [m2/Hz/rad]\n0.1,1\n", "without a column 'direction_from"),
        ("frequency [Hz],density [m2/Hz/rad],direction_to [deg]\n0.1,1,0\n0.1,1,90\n0.2,1,0\n",
         "no row of 0.2 Hz with the direction to 90 deg"),
        ("frequency [Hz],density [m2/Hz/rad],direction_to [deg]\n0.1,1,0\n0.1,1,360\n",
         "a.csv:3: 0.1 Hz and this direction are there twice"),
    ],
)  # fmt: skip
def test_csv_that_is_none(tmp_path, text, words):
    with pytest.raises(ConfigError, match=words) as error:
        read_spectrum(csv(tmp_path, text))
    assert str(error.value).count("\n") == 0 and "a.csv" in str(error.value)


@pytest.mark.parametrize(
    ("pick", "directions", "changes", "words"),
    [
        ("", "", {}, "has 3 of dimension 'time': pick one"),
        ("time=#3, station=#0", "", {}, "time = #3: allowed is #0 to #2"),
        ("time=noon, station=#0", "", {}, "allowed is an instant"),
        ("time=#0, station=2", "", {}, "it has no values"),
        ("hour=1", "", {}, "no dimension 'hour'; did you mean|no dimension 'hour'"),
        ("time", "", {}, "allowed is as"),
        ("time=#0, station=#0", "up", {}, "allowed is 'from' or 'to'"),
        ("time=#0, station=#0", "", {"standard_name": ""}, "does not say whether"),
        ("time=#0, station=#0", "", {"units": "grad"}, "units = 'grad': allowed is deg, rad"),
    ],
)
def test_netcdf_that_does_not_say_enough(tmp_path, pick, directions, changes, words):
    path = ww3(tmp_path, **changes)
    with pytest.raises(ConfigError, match=words) as error:
        read_spectrum(path, pick, directions)
    assert str(error.value).count("\n") == 0


def test_files_that_are_none(tmp_path):
    broken = tmp_path / "a.nc"
    whole = ww3(tmp_path).read_bytes()
    for data in (b"", b"hello", b"CDF\x01" + b"\0" * 40, b"\x89HDF\r\n\x1a\n" + b"\0" * 200,
                 whole[:700], whole[: len(whole) // 2]):  # fmt: skip
        broken.write_bytes(data)
        with pytest.raises(ConfigError, match=r"a\.nc"):
            read_spectrum(broken)
    for path, words in (("a.txt", "suffix"), ("none.nc", "no such file"), ("none.csv", "no such")):
        with pytest.raises(ConfigError, match=words):
            read_spectrum(tmp_path / path)
    with pytest.raises(ConfigError, match="netCDF only"):
        read_spectrum(csv(tmp_path, HEAD + rows(F, S)), "time=#0")
    nothing = saved(tmp_path, {"hs": ("time", [1.0])}, {"time": TIMES[:1]}, name="c.nc")
    with pytest.raises(ConfigError, match="no variable of a wave spectrum"):
        read_spectrum(nothing)


def test_hdf5_whose_data_lie_elsewhere_is_refused(tmp_path):
    h5py = pytest.importorskip("h5py")
    path = tmp_path / "a.nc"
    with h5py.File(path, "w") as file:
        file["efth"] = h5py.ExternalLink("/etc/hostname", "/efth")
    with pytest.raises(ConfigError, match="another file"):
        read_spectrum(path)
    with h5py.File(path, "w") as file:
        file.create_dataset("f", (3,), "f8", external=[("/etc/hostname", 0, 24)])
    with pytest.raises(ConfigError, match="another file"):
        read_spectrum(path)


def test_an_hdf5_file_that_keeps_its_library_busy_is_refused_in_time(tmp_path, monkeypatch):
    """The child is stopped; one that ends by itself without an answer is told of, too."""
    path = ww3(tmp_path)
    here = read_spectrum(path, "time=#0, station=#1")
    monkeypatch.setattr(spectrum_netcdf, "can_read_apart", lambda: True)
    assert read_spectrum(path, "time=#0, station=#1") == here
    monkeypatch.setattr(hdf5_child, "LONGEST", 0.01)
    with pytest.raises(ConfigError, match="does not come back"):
        read_spectrum(path)
    monkeypatch.setattr(hdf5_child, "LONGEST", 60.0)
    monkeypatch.setattr(hdf5_child, "_CALL", "import os; os._exit(9)")
    with pytest.raises(ConfigError, match="ended with code 9"):
        read_spectrum(path)
