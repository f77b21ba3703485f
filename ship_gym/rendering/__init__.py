"""Pictures of a running environment, fast enough for videos: ``render_mode="rgb_array"``.

`Scene` is what a picture needs, plain numbers. ``ship_gym.rendering.plan_view.PlanView`` draws it;
that module needs Pillow, so it is not imported here.
"""

from __future__ import annotations

from ship_gym.rendering.scene import Scene

__all__ = ["Scene"]
