"""From samples to fitted models: one for each quantity of each propeller and rudder."""

from __future__ import annotations

import dataclasses

import numpy as np

from ship_gym.config import ConfigError, check_known
from ship_gym.csv_file import read_csv
from ship_gym.surrogates.base import SurrogateModel, held_out_score, percent_error
from ship_gym.surrogates.error_budget import has_grids, sigma_n, sigma_n_limit
from ship_gym.surrogates.gaussian_process import GaussianProcess
from ship_gym.surrogates.neural_net import NeuralNetwork
from ship_gym.surrogates.regression import FEATURES, Regression
from ship_gym.surrogates.samples import DATA, DataSet, Samples
from ship_gym.surrogates.two_fidelities import TwoFidelities

FAMILIES = ("regression", "gp", "nn")
NOISES = ("printed", "computed", "given", "none")
_PRINTED_NOISE = DATA / "printed_noise.csv"
INTERPOLATING = 1e-4  # sigma_n with which a process passes through its points, as in the thesis
PRINTED_FORCES, PRINTED_COEFFICIENTS = "forces of the samples", "printed regression coefficients"


@dataclasses.dataclass(frozen=True)
class Options:
    """How to fit.

    Attributes
    ----------
    family : str
        ``regression``, ``gp`` (Gaussian process) or ``nn`` (ensemble of neural networks).
    order : str
        Features of the regression, one of ``regression.FEATURES``.
    noise : str
        Of the process: as ``printed`` in the thesis (for ONRT's C_Mz, which it leaves out, by the
        rule that gives its other values), ``computed`` from the spread of grids and turbulence
        models, ``given`` with each point of the samples, or ``none`` (sigma_n = 1e-4, through the
        points).
    seed : int
        Of the networks.
    cheap : str
        Grid and turbulence model, as in ``G1_SA``, of the many cheap samples on which the process
        builds, see `two_fidelities`; empty: the samples stand alone.
    """

    family: str = "regression"
    order: str = "second"
    noise: str = "printed"
    seed: int = 0
    cheap: str = ""

    def __post_init__(self):
        check_known("surrogate family", self.family, FAMILIES)
        check_known("regression order", self.order, FEATURES)
        check_known("noise", self.noise, NOISES)
        if self.cheap and self.family != "gp":
            raise ConfigError(f"cheap = {self.cheap!r}: two fidelities are of the Gaussian process")


@dataclasses.dataclass(frozen=True)
class Fit:
    """Fitted models of a data set.

    Attributes
    ----------
    trained_on : str
        Printed forces, or printed coefficients where the points are not printed.
    training, validation : dict
        Propeller and rudder to its samples; the validation samples have no values where none are
        printed. Both as the file has them, see `comparable`.
    models : dict
        Propeller and rudder to quantity to model, in the axes of the source.
    """

    data: DataSet
    grid: str
    turbulence: str
    options: Options
    trained_on: str
    training: dict[str, Samples]
    validation: dict[str, Samples]
    models: dict[str, dict[str, SurrogateModel]]

    @property
    def name(self) -> str:
        """Short name, e.g. ``G2_SA``, ``G2_SA_third``, ``gp`` or ``gp_exact`` (without noise)."""
        parts = (self.grid, self.turbulence, self.data.training_set)
        choice = "_".join(part for part in parts if part) or self.data.name
        family = self.options.family
        if family != "regression":
            family += "_exact" if family == "gp" and self.options.noise == "none" else ""
            family += f"_on_{self.options.cheap}" if self.options.cheap else ""
            default = not self.data.choices or (self.grid, self.turbulence) == self.data.choices[0]
            return family if default else f"{family}_{choice}"
        return choice if self.options.order == "second" else f"{choice}_{self.options.order}"

    def comparable(self, samples: Samples, side: str) -> Samples:
        """Samples as the models of a side predict them, see ``DataSet.by_model_speed``.

        The error of a rudder coefficient is then that of the force, because the force is had from
        the rudder speed of the fitted thrust.
        """
        return comparable(self.data, samples, self.models[side])

    def errors(self, side: str) -> dict[str, list[float]]:
        """100 (CFD - model) / CFD [%] on the held-out points; empty without any."""
        held = self.validation[side]
        if not len(held.points):
            return {}
        return {
            name: percent_error(y, self.models[side][name].predict(held.X)[0]).tolist()
            for name, y in self.comparable(held, side).values.items()
        }

    def scores(self, side: str) -> dict[str, dict[str, float]]:
        """`base.held_out_score` of every quantity; empty without held-out points."""
        held = self.validation[side]
        if not len(held.points):
            return {}
        models, values = self.models[side], self.comparable(held, side).values
        return {name: held_out_score(models[name], held.X, y) for name, y in values.items()}


def comparable(data: DataSet, samples: Samples, models: dict[str, SurrogateModel]) -> Samples:
    """Samples with the rudder speed of a fitted thrust where the data set wants it."""
    if not (data.by_model_speed and samples.values and len(samples.points)):
        return samples
    return samples.by_rudder_speed_of(data.thrust, models[data.thrust].predict(samples.X)[0])


def fit(
    data: DataSet, options: Options | None = None, grid: str | None = None, turbulence: str = ""
) -> Fit:
    """Fit every quantity of a data set.

    Where the forces of the training points are not printed (KCS with k-omega SST, the 16 points of
    ONRT), the printed regression coefficients take the place of the fit. The propeller's side force
    of KCS is known by its printed coefficients only.

    Parameters
    ----------
    data : DataSet
    options : Options, optional
        Second-order regression if omitted.
    grid, turbulence : str, optional
        One of ``data.choices``; the first if omitted.

    Raises
    ------
    ConfigError
        Unknown choice, points missing, too few or degenerate points for the model, or another
        model than the one whose coefficients are printed.
    """
    options = options or Options()
    if grid is None:
        grid, turbulence = data.choices[0] if data.choices else ("", "")
    if options.cheap and options.cheap == "_".join(filter(None, (grid, turbulence))):
        raise ConfigError(f"cheap = {options.cheap!r}: is the dear grid itself; name another one")
    training, validation, models = {}, {}, {}
    trained_on = PRINTED_FORCES
    for side in data.sides:
        points = data.read(grid, turbulence, side)
        printed = data.printed(f"{grid}_{turbulence}", side)
        validation[side] = _present(points, data.validation)
        if set(data.training) <= set(points.points.tolist()) or not printed:
            training[side] = points.pick(data.training)
            models[side] = fit_models(data, training[side], options, side)
            extra = set(printed) - set(models[side])
        else:
            trained_on = PRINTED_COEFFICIENTS
            _check_printed(data, grid, turbulence, options)
            training[side] = data.training_places(side)
            models[side], extra = {}, set(printed)
        models[side].update({k: Regression("second", printed[k]) for k in sorted(extra)})
    return Fit(data, grid, turbulence, options, trained_on, training, validation, models)


def _check_printed(data: DataSet, grid: str, turbulence: str, options: Options) -> None:
    """Refuse to pass printed coefficients off as another model than they are."""
    if (options.family, options.order) != ("regression", "second"):
        raise ConfigError(
            f"{data.name} {grid} {turbulence}: the coefficients of its regression are printed, not "
            f"its forces; family = {options.family!r}, order = {options.order!r}: allowed is "
            "'regression', 'second'"
        )


def _present(points: Samples, wanted: tuple[int, ...]) -> Samples:
    """Held-out points, none of them if some are not printed."""
    return points.pick(wanted if set(wanted) <= set(points.points.tolist()) else ())


def fit_models(
    data: DataSet, training: Samples, options: Options, side: str
) -> dict[str, SurrogateModel]:
    """One model for each quantity of some training points; the thrust first, see `comparable`."""
    thrust = new_model(data, options, side, data.thrust, training)
    thrust.fit(training.X, training.values[data.thrust])
    found = {
        name: new_model(data, options, side, name, training).fit(training.X, y)
        for name, y in comparable(data, training, {data.thrust: thrust}).values.items()
        if name != data.thrust
    }
    return {name: thrust if name == data.thrust else found[name] for name in training.values}


def new_model(
    data: DataSet, options: Options, side: str, quantity: str, training: Samples | None = None
) -> SurrogateModel:
    """An unfitted model of the family asked for; a given noise is that of the `training` points."""
    if options.family == "regression":
        return Regression(options.order)
    if options.family == "nn":
        # Powers up to the second, not Knight & Maki's sixth: between eight points those bend faster
        # than a force table resolves, and leave-one-out does not favour them.
        return NeuralNetwork(order="second", seed=options.seed)
    noise = noise_of(data, options.noise, side, quantity, training)
    if options.cheap:
        return TwoFidelities(_cheap(data, options, side, quantity), noise)
    return GaussianProcess(noise)


def _cheap(data: DataSet, options: Options, side: str, quantity: str) -> GaussianProcess:
    """Process of the cheap samples, without the points that are held out."""
    named = {"_".join(filter(None, choice)): choice for choice in data.choices}
    choice = named[check_known(f"cheap samples of {data.name}", options.cheap, named)]
    points = data.read(*choice, side)
    samples = points.pick([p for p in points.points.tolist() if p not in data.validation])

    def process(name: str, y: np.ndarray) -> GaussianProcess:
        return GaussianProcess(noise_of(data, options.noise, side, name, samples)).fit(samples.X, y)

    thrust = process(data.thrust, samples.values[data.thrust])
    if quantity == data.thrust:
        return thrust
    return process(quantity, comparable(data, samples, {data.thrust: thrust}).values[quantity])


def noise_of(
    data: DataSet, noise: str, side: str, quantity: str, samples: Samples | None = None
) -> float | np.ndarray:
    """sigma_n of the process [unit of the quantity]; one of each point if it is given with them.

    Computed: by ``error_budget.sigma_n``, or ``sigma_n_limit`` without the grids that it compares.
    """
    if noise == "none":
        return INTERPOLATING
    if noise == "given":
        if samples is None or quantity not in samples.noise:
            raise ConfigError(f"{data.path}: no column '{quantity} std [-]' for noise = 'given'")
        return samples.noise[quantity]
    columns = read_csv(data.path).columns
    if noise == "printed":
        rows = read_csv(_PRINTED_NOISE).where(data=data.name, side=side, quantity=quantity)
        if len(rows.rows):
            return float(rows.columns["sigma_n"][0])
    if "turbulence" not in columns or "grid" not in columns:
        raise ConfigError(
            f"{data.path}: no columns grid and turbulence to compute the noise from; allowed is "
            "noise = 'none'"
        )
    if noise == "printed" or not has_grids(data):
        return sigma_n_limit(data, quantity, side)
    return sigma_n(data, quantity, side)


def leave_one_out(make, X: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Prediction at each point by a model that has not seen it, shape (n,).

    Parameters
    ----------
    make : callable
        Makes an unfitted model.
    """
    keep = ~np.eye(len(y), dtype=bool)
    return np.array([make().fit(X[k], y[k]).predict(X[~k])[0][0] for k in keep])
