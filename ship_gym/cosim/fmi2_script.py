"""A ship of Ship Gym as FMU. The file `write_fmu` puts into it; Ship Gym itself stays outside."""

import sys
from pathlib import Path

from pythonfmu import Fmi2Slave

try:
    from ship_gym.cosim import fmi2
except ImportError as error:
    raise ImportError(
        f"this FMU needs Ship Gym in the Python that runs it, {sys.executable} {sys.version[:6]}: "
        f'pip install "ship-gym" there ({error})'
    ) from None


class ShipInSea(Fmi2Slave):  # pythonfmu looks for a class with this base in the text of the file
    """Hands every call on to a unit. No exception leaves: pythonfmu would end the process."""

    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self.guarded = fmi2.open_unit(self, Path(self.resources))

    def to_xml(self, model_options=None):
        """The model description, with units, limits and what is known at the start."""
        return fmi2.completed(super().to_xml(model_options or {}), self.guarded.unit)

    def setup_experiment(self, start_time, stop_time=None, tolerance=None):
        """Note the time of the start."""
        self.guarded.unit.start_time = start_time

    def exit_initialization_mode(self):
        """Put the ship at the start."""
        self.guarded.start()

    def do_step(self, current_time, step_size):
        """Sail one communication step; a ship that cannot stays where she is."""
        return self.guarded.step(current_time, step_size)

    def _get_fmu_state(self):
        return self.guarded.stored()

    def _set_fmu_state(self, state):
        self.guarded.restore(state)

    _fmu_state_from_bytes = staticmethod(fmi2.state_from_bytes)
