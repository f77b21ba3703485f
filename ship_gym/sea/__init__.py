"""The sea: current and disturbance now; waves and wind have their room here."""

from ship_gym.sea.state import CALM, Sea, available_seas, load_sea

__all__ = ["CALM", "Sea", "available_seas", "load_sea"]
