"""Our synthetic Tables 3 and 4 of Knight & Maki (2020) beside theirs."""

from __future__ import annotations

from typing import Any

from reproduce.unsteady import EARLY_STOPPING, NOISE, OUTPUTS, REGRESSION_ORDER
from ship_gym.csv_file import CsvTable, read_csv
from ship_gym.text import paragraph, table

COLUMNS = ("training_loss", *OUTPUTS, "loss")


def printed_rows(rows: CsvTable, labels: list[str]) -> dict[str, dict[str, float]]:
    """Rows of a printed table by label."""
    return {
        label: {name: float(rows.columns[name][i]) for name in COLUMNS}
        for i, label in enumerate(labels)
    }


def as_dict(comparison: dict[str, Any]) -> dict[str, Any]:
    """Comparison and what the source prints, as plain numbers, for ``--json``.

    Parameters
    ----------
    comparison : dict
        Of ``unsteady.compare_seeds``.
    """
    orders, stopping = read_csv(REGRESSION_ORDER), read_csv(EARLY_STOPPING)
    levels = [f"{level:.1e}" for level in stopping.columns["training_loss"]]
    return {
        "synthetic": True,
        "noise": NOISE,
        **comparison,
        "printed_orders": printed_rows(orders, orders.columns["order"].tolist()),
        "printed_stopping": printed_rows(stopping, levels),
    }


def as_text(data: dict[str, Any]) -> str:
    """Comparison as a report for people, from `as_dict`."""
    seeds = data["seeds"]
    return "\n".join(
        [
            paragraph(
                "SYNTHETIC unsteady series: motions and Eq. 21 of Knight & Maki (2020), wake of "
                f"the ship file, noise {data['noise']:.4f} on the scaled outputs; median of "
                f"{len(seeds)} seeds. Root mean square errors on the validation case."
            ),
            "",
            "regression by its features, behind the hull (Table 4)",
            _beside(data["orders"], data["printed_orders"]),
            "",
            "network by the training loss at which it is stopped, behind the hull (Table 3; "
            "8.3e-05 is their choice)",
            _beside(data["stopping"], data["printed_stopping"]),
            "",
            "regression by its features, open water, errors on the test case (not printed)",
            _beside(data["open_water"], {}),
            "",
            "loss on the test cases, behind the hull",
            table(
                ["", "second order", "network"],
                [
                    [k, _number(v["second"]), _number(v["network"])]
                    for k, v in data["tests"].items()
                ],
            ),
            "",
            "share of the seeds in which it holds",
            table(["", ""], [[text, f"{share:.0%}"] for text, share in data["held"].items()]),
        ]
    )


def _beside(ours: dict, printed: dict) -> str:
    """Ours and, if there are any, printed values of every column side by side."""
    header = [""]
    for name in COLUMNS:
        header += [name.replace("training_", "training "), *(["printed"] if printed else [])]
    labels = [*printed, *(k for k in ours if k not in printed)]
    rows = []
    for label in labels:
        cells = [label]
        for name in COLUMNS:
            cells.append(_number(ours.get(label, {}).get(name)))
            if printed:
                cells.append(_number(printed.get(label, {}).get(name)))
        rows.append(cells)
    return table(header, rows)


def _number(value: float | None) -> str:
    return "" if value is None else f"{value:.1e}"
