"""A master that is no Python program sails a ship's FMU too."""

import os
import shutil
import subprocess
import sys
import sysconfig
import zipfile
from pathlib import Path

import pytest

fmpy = pytest.importorskip("fmpy")
pytest.importorskip("pythonfmu")

from ship_gym.cosim import write_fmu  # noqa: E402
from ship_gym.simulation import ShipSim  # noqa: E402

COMPILER = shutil.which("gcc") or shutil.which("cc")
LIBRARY = Path(
    sysconfig.get_config_var("LIBDIR") or "", sysconfig.get_config_var("LDLIBRARY") or ""
)


@pytest.mark.slow
@pytest.mark.skipif(sys.platform != "linux" or not COMPILER, reason="needs Linux and a C compiler")
@pytest.mark.skipif(".so" not in LIBRARY.name, reason="this Python has no shared library")
def test_a_master_in_c_gets_the_same_bits(tmp_path):
    write_fmu("kcs", tmp_path / "kcs.fmu")
    with zipfile.ZipFile(tmp_path / "kcs.fmu") as archive:
        archive.extractall(tmp_path / "kcs")
    headers = Path(fmpy.__file__).with_name("c-code")
    source, host = Path(__file__).with_name("host.c"), tmp_path / "host"
    build = [COMPILER, f"-I{headers}", str(source), "-o", str(host), "-ldl"]
    subprocess.run(build, check=True, capture_output=True)
    paths = os.pathsep.join([path for path in sys.path if path])
    done = subprocess.run(
        [
            str(host),
            str(tmp_path / "kcs" / "binaries" / "linux64" / "kcs.so"),
            (tmp_path / "kcs" / "resources").as_uri(),
            fmpy.read_model_description(str(tmp_path / "kcs")).guid,
        ],
        capture_output=True,
        text=True,
        env=os.environ | {"LD_PRELOAD": str(LIBRARY), "PYTHONPATH": paths},
    )
    assert done.returncode == 0, done.stderr
    sim = ShipSim("kcs")
    sim.reset(0)
    n = float(sim.state[0, 7])
    for _ in range(20):
        sim.step([[0.3, n]], 1.0)
    assert [float(line) for line in done.stdout.split()] == sim.state[0].tolist()
    assert done.stderr.startswith("3 rudder command = 35.0 rad: allowed is")
