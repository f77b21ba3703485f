"""Force samples at points (J, beta) with the rudder at one or more angles, and their source."""

from __future__ import annotations

import dataclasses
import math
from pathlib import Path

import numpy as np

from ship_gym.config import ConfigError, check_known
from ship_gym.csv_file import CsvTable, read_csv

DATA = Path(__file__).parent / "data"
SINGLE, LEEWARD, WINDWARD = "single", "leeward", "windward"
RUDDER = ("C_Fx", "C_Fy", "C_Mz")  # columns made dimensionless by the rudder speed


@dataclasses.dataclass(frozen=True)
class Samples:
    """Forces on one propeller and its rudder.

    Attributes
    ----------
    path : str
        File they come from.
    source : str
        Publication.
    points, rows : numpy.ndarray
        Number of each point and its line in the file, shape (n,).
    X : numpy.ndarray
        J [-] and drift angle beta [rad], shape (n, 2), with the rudder angle [rad] (n, 3).
    values : dict
        Quantity to coefficients, shape (n,), in the axes of the source.
    noise : dict
        Quantity to the standard deviation of each point, shape (n,), where the file gives one.
    """

    path: str
    source: str
    points: np.ndarray
    rows: np.ndarray
    X: np.ndarray
    values: dict[str, np.ndarray]
    noise: dict[str, np.ndarray] = dataclasses.field(default_factory=dict)

    def delta(self, fixed: float) -> float | np.ndarray:
        """Rudder angle of the points [rad]: shape (n,) where it is an input, else the fixed one."""
        return self.X[:, 2] if self.X.shape[1] > 2 else fixed

    def pick(self, points) -> Samples:
        """Some points, in the order asked for.

        Raises
        ------
        ConfigError
            A point is missing or there twice.
        """
        found = [np.flatnonzero(self.points == point) for point in points]
        wrong = [int(p) for p, hits in zip(points, found, strict=True) if len(hits) != 1]
        if wrong:
            raise ConfigError(f"{self.path}: points {wrong} must be there once")
        order = np.array([hits[0] for hits in found], dtype=int)
        values = {name: column[order] for name, column in self.values.items()}
        noise = {name: column[order] for name, column in self.noise.items()}
        return dataclasses.replace(
            self,
            points=self.points[order],
            rows=self.rows[order],
            X=self.X[order],
            values=values,
            noise=noise,
        )

    def by_rudder_speed_of(self, thrust: str, K_T: np.ndarray) -> Samples:
        """The same rudder forces, made dimensionless by the rudder speed of another thrust.

        Parameters
        ----------
        thrust : str
            Column of the thrust coefficient whose rudder speed the coefficients have now.
        K_T : numpy.ndarray
            Thrust coefficient [-] whose rudder speed they get, shape (n,).
        """
        old, new = (rudder_speed_squared(self.X, k) for k in (self.values[thrust], K_T))
        of_rudder = {k: v * old / new for k, v in self.values.items() if k in RUDDER}
        return dataclasses.replace(self, values={**self.values, **of_rudder})


def rudder_speed_squared(X: np.ndarray, K_T: np.ndarray) -> np.ndarray:
    """(u_R / u)^2 = 1 + 8 K_T / (pi J^2) + tan(beta)^2 in pure drift, Knight (2021) Eqs. 2.19-2.22.

    Eq. 2.20 is printed as u_Rx = u (1 + C_T), without a root, which momentum theory has. The root
    it is: with it our regressions of ONRT meet the printed ones to 0.0007, without it to 0.0031.

    Parameters
    ----------
    X : numpy.ndarray
        J [-] and beta [rad], shape (n, 2), or with the rudder angle (n, 3).
    K_T : numpy.ndarray
        Thrust coefficient, or K_X, shape (n,).
    """
    J, beta = X.T[:2]
    return 1.0 + 8.0 * K_T / (math.pi * J**2) + np.tan(beta) ** 2


@dataclasses.dataclass(frozen=True)
class DataSet:
    """A table of samples for one ship, and how its columns and axes are to be read.

    Attributes
    ----------
    name, ship : str
        Its name and the ship it belongs to.
    path, coefficients : Path
        Points; regression coefficients that the source prints, if it does.
    delta : float
        Size of the rudder angle [rad]; the largest of several.
    thrust : str
        Column of the axial force coefficient: ``K_T``, or ``K_X`` along the ship's axis.
    quantities : tuple of str
        Columns that are fitted.
    sides : dict
        Propeller and rudder to their name in the column ``side``: ``single``, or ``leeward`` (on
        the inner side of the turn) and ``windward``.
    to_port : bool
        The samples are of a turn to port: side forces change their sign for a turn to starboard.
    box : tuple of float
        Sampled region: J from, to; beta from, to [rad].
    training, validation : tuple of int
        Points to fit to and points held out.
    choices : tuple
        Grids and turbulence models, the default first; empty without such columns.
    angles : tuple of float
        Rudder angles of the file that belong to the set [rad]: one, or several as a third input;
        empty where the file has no column ``delta``.
    by_model_speed : bool
        The fitted rudder coefficients refer to the rudder speed of the fitted thrust, as Knight
        (2021) section 5.3.1 says of ONRT; those of the file to that of the CFD's thrust.
    places : Path, optional
        Where the training points lie, if their forces are not in `path`.
    training_set : str
        Name of the training set, where it is not the usual one of the ship.
    """

    name: str
    ship: str
    path: Path
    delta: float
    thrust: str
    quantities: tuple[str, ...]
    sides: dict[str, str]
    box: tuple[float, float, float, float]
    training: tuple[int, ...]
    validation: tuple[int, ...]
    to_port: bool = False
    coefficients: Path | None = None
    choices: tuple[tuple[str, str], ...] = ()
    angles: tuple[float, ...] = ()
    by_model_speed: bool = False
    places: Path | None = None
    training_set: str = ""

    @property
    def sign(self) -> float:
        """Factor of side forces and yaw moments to a turn to starboard in the source's axes."""
        return -1.0 if self.to_port else 1.0

    def read(self, grid: str = "", turbulence: str = "", side: str = SINGLE) -> Samples:
        """All points of one propeller and rudder on one grid with one turbulence model."""
        rows = read_csv(self.path)
        for column, wanted in (("grid", grid), ("turbulence", turbulence)):
            if wanted:
                rows.require(column)
                check_known(f"{column} of {self.name}", wanted, sorted(set(rows.columns[column])))
        conditions = {"grid": grid, "turbulence": turbulence, "side": self.sides[side]}
        rows = rows.where(**{k: v for k, v in conditions.items() if v})
        if self.angles:
            rows = rows.select(np.isin(rows.si("delta"), self.angles))
        return samples_of(rows, self.quantities, len(self.angles) > 1)

    def printed(self, model: str, side: str = SINGLE) -> dict[str, np.ndarray]:
        """Second-order coefficients that the source prints for a model, e.g. ``"G2_SA"``.

        Returns
        -------
        dict
            Quantity to coefficients, shape (6,), in the order of ``regression.FEATURES``; empty if
            the source prints none.
        """
        if self.coefficients is None:
            return {}
        rows = read_csv(self.coefficients)
        count = f" {len(self.training)}" if len(self.sides) > 1 else ""
        wanted = {"model": model.replace("_", " ") + count}
        if self.sides[side]:
            wanted["side"] = self.sides[side]
        rows = rows.where(**wanted)
        if not len(rows.rows):
            return {}
        found = {k: rows.columns[k] for k in self.quantities if k in rows.columns}
        if "-10K_S" in rows.columns:
            found["K_S"] = -0.1 * rows.columns["-10K_S"]
        return found

    def training_places(self, side: str = SINGLE) -> Samples:
        """Training points without values, for models of printed coefficients."""
        if self.places is not None:
            return samples_of(read_csv(self.places), ()).pick(self.training)
        known = self.read(*self.choices[0], side).pick(self.training)
        return dataclasses.replace(known, values={})


def samples_of(rows: CsvTable, quantities, rudder: bool = False) -> Samples:
    """Samples from the rows of a file, with or without the rudder angle as third input.

    The drift column may be ``beta`` or ``abs(beta)``.
    """
    beta = "abs(beta)" if "abs(beta)" in rows.columns else "beta"
    inputs = ("J", beta, "delta") if rudder else ("J", beta)
    rows.require("point", *inputs, *quantities)
    return Samples(
        path=rows.path,
        source=rows.header["source"],
        points=rows.columns["point"].astype(int),
        rows=rows.rows,
        X=np.stack([rows.si(name) for name in inputs], axis=1),
        values={name: rows.columns[name] for name in quantities},
        noise={k: rows.columns[f"{k} std"] for k in quantities if f"{k} std" in rows.columns},
    )


# Points 1-4 are held out and 5-12 fitted, as in the thesis. The boxes are those of its Latin
# hypercubes: half a cell beyond the outermost points.
KCS = DataSet(
    name="kcs",
    ship="kcs_model",
    path=DATA / "kcs_propeller_rudder_cfd.csv",
    coefficients=DATA / "kcs_regression_coefficients.csv",
    delta=math.radians(35.0),
    thrust="K_T",
    quantities=("K_T", "10K_Q", "C_Fx", "C_Fy"),
    sides={SINGLE: ""},
    box=(0.2, 0.9, 0.0, math.radians(45.0)),
    training=(5, 6, 7, 8, 9, 10, 11, 12),
    validation=(1, 2, 3, 4),
    choices=(("G2", "SA"), ("G1", "SA"), ("G2", "SST"), ("G3", "SA")),
)
ONRT = DataSet(
    name="onrt",
    ship="onrt_model",
    path=DATA / "onrt_propeller_rudder_cfd.csv",
    coefficients=DATA / "onrt_regression_coefficients.csv",
    delta=math.radians(35.0),
    thrust="K_X",
    quantities=("K_X", "K_S", "C_Fx", "C_Fy", "C_Mz"),
    # the samples' turn is to port, so the port propeller is on the inner, leeward side
    sides={LEEWARD: "port", WINDWARD: "starboard"},
    box=(0.55, 1.35, 0.0, math.radians(35.0)),
    training=(5, 6, 7, 8, 9, 10, 11, 12),
    validation=(1, 2, 3, 4),
    to_port=True,
    choices=(("G2", "SA"), ("G1", "SA"), ("G2", "SST"), ("G3", "SA")),
    by_model_speed=True,
)
# The 16-point set of ONRT: its coefficients are printed (Table B.13) and its places (Table B.1).
ONRT_16 = dataclasses.replace(
    ONRT,
    name="onrt_16",
    training=tuple(range(13, 29)),
    choices=(("G2", "SA"),),
    places=DATA / "onrt_points.csv",
    training_set="16",
)
DATA_SETS = {data.name: data for data in (KCS, ONRT, ONRT_16)}
