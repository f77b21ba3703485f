"""Speed as tables for people, from what ``ship-gym speed`` measured."""

from __future__ import annotations

from typing import Any

from ship_gym.text import table

_ONE_STEP = (
    "One step is one control interval (1 s at full scale) of one ship. Of one core: processor "
    "time;\nof threads: wall time; best of several repeats, spread the slowest above it."
)


def as_text(data: dict[str, Any]) -> str:
    """All tables.

    Parameters
    ----------
    data : dict
        ``machine``, ``steps``, ``growth``, ``waves`` (rows of ``speed.measure``), ``overhead``,
        ``memory``, ``peers``, ``training`` and ``start``; what was left out is empty.
    """
    host = data["machine"]
    parts = [
        f"{host['processor']}, {host['cores']} cores, Python {host['versions']['python']}",
        *(["", _ONE_STEP, "", _steps(data["steps"]), ""] if data["steps"] else []),
        *_by_n("Processor time of one step [us] against the number of ships", data["growth"]),
        *_by_n("Processor time of one step [us] against the number of waves", data["waves"]),
        *(
            f"{o['scenario']}, n = {o['n']}: task, observation, reward and info cost "
            f"{o['percent']:.0f} % of the physics ({1e6 * o['physics'] / o['n']:.2f} us a ship)"
            for o in data["overhead"]
        ),
        *_memory(data["memory"]),
        *_peers(data["peers"]),
        *_training(data["training"]),
        *(["", *(f"{k}: {t:.2f} s" for k, t in data["start"].items())] if data["start"] else []),
    ]
    return "\n".join(parts)


def _us(seconds: float) -> str:
    return f"{1e6 * seconds:.4g}"


def _steps(rows: list[dict]) -> str:
    cells = [
        [
            row["name"],
            str(row["n"]),
            f"{1.0 / row['seconds']:,.0f}",
            _us(row["processor"]),
            _us(row["wall"]),
            f"{row['spread_percent']:.0f} %" if row["spread_percent"] < 1000.0 else "> 1000 %",
        ]
        for row in rows
    ]
    return table(["", "n", "steps/s", "us processor", "us wall", "spread"], cells)


def by_name(rows: list[dict]) -> dict[str, dict[int, float]]:
    """Rows of one table as name to n to seconds."""
    found: dict[str, dict[int, float]] = {}
    for row in rows:
        found.setdefault(row["name"], {})[row["n"]] = row["seconds"]
    return found


def _by_n(title: str, rows: list[dict]) -> list[str]:
    curves = by_name(rows)
    if not curves:
        return []
    counts = sorted({row["n"] for row in rows})
    cells = [[name, *(_us(c[n]) if n in c else "" for n in counts)] for name, c in curves.items()]
    return [title, "", table(["", *(str(n) for n in counts)], cells), ""]


def _memory(found: dict[str, float | None]) -> list[str]:
    if not found:
        return []
    sizes = ", ".join(f"{k} {v:,.0f}" for k, v in found.items() if v is not None)
    return [
        "",
        f"Memory of one environment more [bytes]: {sizes}",
        "(arrays of the physics; and of task, observation and info; and of the spaces; growth of "
        "the process)",
    ]


def _peers(rows: list[dict]) -> list[str]:
    if not rows:
        return []
    cells = [
        [r["name"], r["what"], f"{_us(r['seconds'])} us" if r["seconds"] else r["reason"]]
        for r in rows
    ]
    text = "One second at sea, calm water, of a ship of each one's own, processor time"
    return ["", text, "", table(["", "what is called", "a step"], cells, left=3)]


def _training(found: dict[str, Any]) -> list[str]:
    if not found:
        return []
    if "reason" in found:
        return ["", f"Training: {found['reason']}"]
    how = "side by side" if found["side_by_side"] else "one after the other"
    text = (
        f"Training, {found['algorithm']}, {found['envs']} environments, {found['epochs']} epochs, "
        f"{found['threads']} torch threads, {found['cores']} cores, load {found['load'] or 0:.1f}: "
        f"{found['samples_per_second']:,.0f} samples/s (wall time, {found['samples']:,} samples; "
        f"sailing takes {found['sailing_percent']:.0f} % of it and learning "
        f"{found['learning_percent']:.0f} %, {how})"
    )
    if plain := found["plain"]:
        text += (
            f"\nStable-baselines3's PPO on DummyVecEnv, same task, network and batch: "
            f"{plain['samples_per_second']:,.0f} samples/s ({plain['samples']:,} samples, learning "
            f"{plain['learning_percent']:.0f} %); ours is {plain['ratio']:.1f} times as fast"
        )
    return ["", text]
