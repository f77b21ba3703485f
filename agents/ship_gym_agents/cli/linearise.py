"""``ship-gym linearise``."""

from __future__ import annotations

from typing import Any

import click

from ship_gym_agents.cli import options
from ship_gym_agents.cli.values import Number


@options.verb("--ship kcs", "--ship mine/ship.toml --speed 5.0 --json")
@options.ship(default="kcs")
@click.option(
    "--speed",
    type=Number(0.01, 100.0, "m/s"),
    help="Through the water [m/s]; default: the ship's own.",
)
def command(as_json, ship, speed) -> None:
    """Linearise a ship on a straight course: derivatives, Nomoto's K and T, stability."""
    from ship_gym.linear import linearise
    from ship_gym_agents.cli.output import next_command, show

    model = linearise(ship, speed)
    following = next_command("tune", ship=ship)
    show(as_json, model.as_dict(), f"{_text(model)}\nnext: {following}")


def _text(m: Any) -> str:
    """Model as tables."""
    import dataclasses
    import math

    from ship_gym.text import table

    rows = [(k, f"{x:.4f}") for k, x in dataclasses.asdict(m.steering).items()]
    prime = dataclasses.asdict(m.steering.nomoto)
    nomoto = [
        (k, f"{x:.5g}", "1/s" if k == "K" else "s", f"{prime[k]:.4f}")
        for k, x in dataclasses.asdict(m.nomoto).items()
    ]
    poles = ", ".join(
        f"{x.real:.5f}" if x.imag == 0.0 else f"{x.real:.5f} {x.imag:+.5f} i" for x in m.eigenvalues
    )
    valid = m.valid
    return "\n".join(
        [
            f"{m.ship} at {m.speed:.4g} m/s, propeller {m.n0:.4g} rev/s, rudder "
            f"{math.degrees(m.delta0):.3g} deg, calm deep water",
            "",
            "dv'/dt' = Y_v v' + Y_r r' + Y_delta delta, dr'/dt' = N_v v' + N_r r' + N_delta delta",
            table(("derivative", "value"), rows),
            "",
            "T1 T2 r'' + (T1 + T2) r' + r = K (delta + T3 delta'), T = T1 + T2 - T3",
            table(("Nomoto", "value", "unit", "by L / U"), nomoto),
            "",
            f"eigenvalues of sway and yaw: {poles} 1/s: "
            f"{'stable' if m.stable else 'unstable'} on a straight course",
            f"accelerations within 10 %: |v'| to {valid['v']:.3g}, |r'| to {valid['r']:.3g}, "
            f"rudder to {math.degrees(valid['delta']):.3g} deg",
        ]
    )
