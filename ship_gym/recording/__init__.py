"""Recordings of a rollout: exact columns with their meta, as csv or as a rerun file to look at."""

from __future__ import annotations

from ship_gym.recording.recorder import Recorder
from ship_gym.recording.sealed import DamagedRecording
from ship_gym.recording.trajectory import Trajectory

__all__ = ["DamagedRecording", "Recorder", "Trajectory"]
