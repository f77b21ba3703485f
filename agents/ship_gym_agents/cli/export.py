"""``ship-gym export``."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from ship_gym_agents.cli.options import environment, force, verb
from ship_gym_agents.cli.values import Name, OutFile

_SUFFIX = {"onnx": ".onnx", "safetensors": ".safetensors"}


@verb(
    "runs/quickstart --out policy.onnx             # for a program without this package",
    "old/policy.zip --to safetensors               # a policy of version 0.1",
    "model.zip --trust-sb3-zip --to safetensors    # stable-baselines3's own; runs what it holds",
)
@click.argument("policy", type=Name("controllers"))
@click.option("--to", type=click.Choice(list(_SUFFIX)), default="onnx", help="Kind of file.")
@click.option("--out", type=click.Path(path_type=Path), help="Default: beside the policy.")
@click.option(
    "--trust-sb3-zip",
    "trust",
    is_flag=True,
    help="Read a zip that stable-baselines3 saved, and a vecnormalize.pkl beside it. "
    "THIS RUNS CODE that they may hold: only for files of people you trust.",
)
@force()
@environment("what a zip of stable-baselines3 was trained for: heading_keeping, kcs, rudder")
def command(as_json, policy, to, out, trust, force, task, **options) -> None:
    """Write a policy as ONNX for other programs, or as safetensors from older files.

    POLICY is a name, a file or the folder of a run. An ONNX model holds normaliser and network;
    features and decisions, named in its metadata, are the helm's work. It is compared with the
    policy where onnxruntime is installed.
    """
    from ship_gym_agents.cli.output import need, show

    if to == "onnx":
        need("onnx")
    from ship_gym_agents.cli import replace

    named, out = out, _checked(out, policy, to)
    made = _read(policy, trust, task, options)
    replace.check_replaced(named, replace.policy(made.card), force)
    found = {"policy": made.name, "file": str(out), "form": made.form_in_words}
    found |= _write(made, to, out)
    found |= {"bytes": out.stat().st_size}
    show(as_json, found, _as_text(found))


def _checked(out: Path | None, policy: str, to: str) -> Path:
    """The file to write, refused if it has another extension or is the one that is read."""
    from ship_gym.config import ConfigError

    source = Path(policy)
    if out is None:
        beside = source if source.exists() else Path("runs") / policy
        name = beside / "policy" if beside.is_dir() else beside
        out = name.with_suffix(_SUFFIX[to])
    context = click.get_current_context()
    option = next(param for param in context.command.params if param.name == "out")
    out = OutFile(_SUFFIX[to]).convert(str(out), option, context)
    if out.exists() and (source / "policy.safetensors" if source.is_dir() else source) == out:
        raise ConfigError(f"--out {out}: that is the policy itself")
    return out


def _read(named: str, trust: bool, task: str | None, options: dict[str, Any]):
    """The policy of a name, a file, an older file or, if trusted, one of stable-baselines3."""
    from ship_gym.config import ConfigError
    from ship_gym_agents.cli.output import need
    from ship_gym_agents.cli.sailing import own_task, wanted
    from ship_gym_agents.controllers import make_controller
    from ship_gym_agents.policies.old_zip import is_old, load_old

    if trust:
        need("torch", "stable_baselines3")
        from ship_gym_agents.sb3.sb3_zip import load_sb3_zip

        return load_sb3_zip(named, trust=True, **wanted(options, own_task(task)))
    if Path(named).is_file() and is_old(named):
        return load_old(named)
    found = make_controller(named)
    if not hasattr(found, "card"):
        raise ConfigError(f"{named}: not a policy; only policies can be exported")
    return found


def _write(made: Any, to: str, out: Path) -> dict[str, Any]:
    """Write the file; what is to be told of it."""
    if to == "safetensors":
        from ship_gym_agents.policies.policy_file import save_policy

        save_policy(made, out)
        return {}
    from ship_gym_agents.policies.onnx_check import largest_difference
    from ship_gym_agents.policies.onnx_export import export_onnx

    export_onnx(made, out)
    return {"largest_difference": largest_difference(made, out)}


def _as_text(found: dict[str, Any]) -> str:
    lines = [f"{found['policy']}: {found['form']}"]
    if "largest_difference" in found:
        apart = found["largest_difference"]
        lines.append(
            "not compared: onnxruntime is not installed"
            if apart is None
            else f"decisions of both differ by at most {apart:.1e} over random features"
        )
    lines.append(f"wrote {found['file']} ({found['bytes'] / 1000.0:.0f} kB)")
    if found["file"].endswith(".safetensors"):
        lines.append(f"next: ship-gym evaluate --policy {found['file']}")
    return "\n".join(lines)
