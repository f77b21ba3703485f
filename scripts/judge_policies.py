"""Judge the shipped policies by what they claim, on seeds that nobody has used.

The claims stand in scripts/policy_claims.toml. Rehearse with `--split validation`; the seeds of the
split `final` are looked at once for a set of policies. What is sailed is kept in --run: killed, the
same command goes on.
"""

from __future__ import annotations

import json
from pathlib import Path

from _cli import parser, progress, run, show

from pages import judgement
from pages.policies_page import write_page
from ship_gym.locks import locked
from ship_gym.writing import atomic_path, check_place

PAGE = Path(__file__).resolve().parents[1] / "docs" / "policies.md"
EXAMPLES = (
    "python scripts/judge_policies.py --split validation --seeds 32   # rehearsal, no page",
    "python scripts/judge_policies.py --split final --page            # the one look",
)


def arguments():
    p = parser(__doc__, EXAMPLES)
    p.add_argument("--claims", type=Path, default=Path(__file__).with_name("policy_claims.toml"))
    p.add_argument("--only", nargs="*", help="names of claims (default: all)")
    p.add_argument("--split", default="validation", help="seeds to sail (default validation)")
    p.add_argument("--seeds", type=int, default=128, help="episodes (default 128)")
    p.add_argument("--policies", type=Path, help="folder of runs with all seeds, for their spread")
    p.add_argument("--run", type=Path, default=Path("runs/judgement"), help="what was sailed")
    p.add_argument("--page", action="store_true", help="write docs/policies.md and its pictures")
    return p.parse_args()


def main() -> None:
    args = arguments()
    check_place(args.run, "--run", folder=True)
    if args.page:
        check_place(PAGE, "--page")
    claims = judgement.read_claims(args.claims, args.only)
    with locked(args.run / "lock", "judges in this folder"):
        judged, files = judge(args, claims)
    text = judgement.told(judged)
    show(args.json, {"claims": judged, "files": [str(f) for f in files]}, text)


def judge(args, claims) -> tuple[list, list[Path]]:
    """Sail what is missing and judge; the judgement and the files of the page."""
    sailor = judgement.Sailor(args.split, args.seeds, args.run)
    for one in progress(judgement.plan(claims, args.policies), "sailing"):
        sailor.sail(*one)
    judged = judgement.judge(claims, sailor, args.policies)
    files = write_page(judged, sailor, args.split, PAGE) if args.page else []
    with atomic_path(args.run / f"judged_{args.split}.json") as temporary:
        temporary.write_text(json.dumps(judged, indent=1) + "\n", encoding="utf-8")
    return judged, files


if __name__ == "__main__":
    run(main)
