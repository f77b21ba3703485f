"""Our synthetic numbers beside the tables and test cases of Knight & Maki (2020)."""

from __future__ import annotations

from typing import Any

from reproduce import unsteady_printed
from reproduce.unsteady import EARLY_STOPPING, OUTPUTS, REGRESSION_ORDER
from reproduce.unsteady_series import NOISE
from ship_gym.csv_file import CsvTable, read_csv
from ship_gym.text import paragraph, table

COLUMNS = ("training_loss", *OUTPUTS, "loss")
TEST_COLUMNS = (*OUTPUTS, "loss")
TEST_3 = "test 3: network beats second order on the loss"


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
        "printed_tests": unsteady_printed.tests("behind hull"),
        "printed_open_water": unsteady_printed.tests("open water"),
        "losses": unsteady_printed.losses(),
        "amplitudes": unsteady_printed.amplitudes(),
    }


def as_text(data: dict[str, Any]) -> str:
    """Comparison as a report for people, from `as_dict`."""
    noise = " and ".join(f"{sigma:.4f} {where}" for where, sigma in data["noise"].items())
    return "\n".join(
        [
            paragraph(
                "SYNTHETIC unsteady series: motions and Eq. 21 of Knight & Maki (2020), wake of "
                f"hull set C, noise of the scaled outputs {noise}; median of "
                f"{len(data['seeds'])} seeds. Root mean square errors on the case named."
            ),
            "",
            "regression by its features, behind the hull, validation case (Table 4)",
            _beside(data["orders"], data["printed_orders"]),
            "",
            "network by the training loss at which it is stopped, behind the hull, validation case "
            "(Table 3; 8.3e-05 is their choice)",
            _beside(data["stopping"], data["printed_stopping"]),
            "",
            "test cases behind the hull (sections 4.2.1 to 4.2.3)",
            _beside(data["tests"], data["printed_tests"], TEST_COLUMNS),
            paragraph(_test_3(data)),
            "",
            "test case in open water (sections 3.2.1, 3.2.2)",
            _beside(data["open_water"], data["printed_open_water"], TEST_COLUMNS),
            paragraph(_open_water(data)),
            "",
            "share of the seeds in which it holds; in the print each does",
            table(["", ""], [[text, f"{share:.0%}"] for text, share in data["held"].items()]),
            "",
            _printed_twice(data),
        ]
    )


def _open_water(data: dict[str, Any]) -> str:
    ratio = data["slower"]
    ours = "not reached here" if ratio is None else f"{ratio:.1f} times here"
    return (
        "Our series is made by the printed regression itself, so the regression is at its best and "
        "the network can at most come level: who wins on K_T and K_Q cannot be tried with these "
        "series. A network with the second-order features predicts alike, as they say; to their "
        f"training loss of 3.1e-5 it takes twice the iterations in the print, {ours}."
    )


def _test_3(data: dict[str, Any]) -> str:
    """Why the loss of test 3 is not ordered as in the print, with the numbers of this run."""
    ours = [data["tests"][f"test 3, {m}"] for m in ("network", "second")]
    theirs = [data["printed_tests"][f"test 3, {m}"] for m in ("network", "second")]
    side = 0.5 * ours[0]["K_S"] ** 2 / ours[0]["loss"]
    return (
        f"Test 3: printed {theirs[0]['loss']:.2e} (network) against {theirs[1]['loss']:.2e}; ours "
        f"{ours[0]['loss']:.1e} against {ours[1]['loss']:.1e}, in the printed order for "
        f"{data['held'][TEST_3]:.0%} of the seeds: no factor of four. By quantity the order is "
        "the printed one: the network wins on K_T and K_Q, the regression on K_S. But the side "
        f"force is {side:.0%} of our network's loss: the training set has sway at one J only, so "
        "how K_S changes with J is the network's own guess, while the second order, with least "
        "norm, leaves it nearly constant, as Eq. 21 has it. And our regression misses K_T and K_Q "
        f"by {ours[1]['K_T']:.1e} and {ours[1]['K_Q']:.1e}, theirs by {theirs[1]['K_T']:.1e} and "
        f"{theirs[1]['K_Q']:.1e}: their wake behind the hull joins J and angle more than a thrust "
        "identity does. Their regression misses about as much with sway to the other side "
        "(validation and test 3), so a coefficient of J alpha left where the search began is not "
        "the cause: its part would change its sign. Nor is the way of descent: plain gradient "
        "descent leaves K_S at 3.9e-2 to 4.2e-2 too (two seeds). Nor the noise: with 0.0106, "
        "which would explain their training loss, it is 1.2e-3 against 9.8e-4."
    )


def _printed_twice(data: dict[str, Any]) -> str:
    """What the source prints twice and how far it agrees with itself."""
    parts = []
    for name, what in (("losses", "losses from their errors"), ("amplitudes", "amplitudes")):
        rows = data[name]
        parts.append(
            f"printed twice: {what}, {sum(r['agrees'] for r in rows)} of {len(rows)} agree within "
            "the rounding of the print; not"
        )
        cells = [
            [r["place"], f"{r['printed']:.3g}", f"{r['computed']:.3g}"]
            for r in rows
            if not r["agrees"]
        ]
        parts.append(table(["", "printed", "computed"], cells))
    parts.append(
        paragraph(
            "The printed loss of the regression on test 2 repeats that of the network. Surge of "
            "test 2 is 0.31 of the mean speed in Table 2 and 0.298 in the text; the series here "
            "take the tables."
        )
    )
    return "\n".join(parts)


def _beside(ours: dict, printed: dict, columns: tuple[str, ...] = COLUMNS) -> str:
    """Ours and printed values of every column side by side."""
    header = [""]
    for name in columns:
        header += [name.replace("training_", "training "), "printed"]
    rows = []
    for label in [*printed, *(k for k in ours if k not in printed)]:
        cells = [label]
        for name in columns:
            cells += [_number(values.get(label, {}).get(name)) for values in (ours, printed)]
        rows.append(cells)
    return table(header, rows)


def _number(value: float | None) -> str:
    return "" if value is None else f"{value:.1e}"
