"""What the native vector environment takes from Gymnasium; older ones have it not, or otherwise."""

from __future__ import annotations

import gymnasium

NEEDED = "1.1"  # the first whose vector environments say how they reset: AutoresetMode

try:
    from gymnasium.vector import AutoresetMode, VectorEnv, VectorWrapper
    from gymnasium.vector.utils import batch_space
except ImportError:
    raise ImportError(
        f"the native vector environment needs gymnasium {NEEDED} or newer, {gymnasium.__version__} "
        f'is installed: pip install "gymnasium>={NEEDED}", or step single environments side by '
        'side: gym.make_vec(id, vectorization_mode="sync")'
    ) from None

__all__ = ["AutoresetMode", "VectorEnv", "VectorWrapper", "batch_space"]
