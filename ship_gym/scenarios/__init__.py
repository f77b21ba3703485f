"""Scenarios: one TOML file per environment id, every key of it replaceable."""

from ship_gym.scenarios.scenario import Scenario, available_scenarios, load_scenario

__all__ = ["Scenario", "available_scenarios", "load_scenario"]
