"""Evaluation: controllers, rollouts, metrics and their statistics."""
