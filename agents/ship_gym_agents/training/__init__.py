"""Training runs: budget, checkpoints, validation, several seeds, and the judgement at the end."""
