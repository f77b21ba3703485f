#!/usr/bin/env bash
# Builds the documentation site from docs into build/site, or the folder given, and checks that
# every link inside it leads somewhere. A warning is an error; no network is used.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
exec </dev/null

case "${1:-}" in
-h | --help)
    echo "usage: bash scripts/build_site.sh [FOLDER]   (needs the extra docs; PYTHON, default .venv)"
    exit 0
    ;;
esac
out="${1:-build/site}"
python="${PYTHON:-.venv/bin/python}"
[ -x "$(command -v "$python")" ] || python=python3

"$python" -c 'import sphinx, myst_parser, furo, sphinx_copybutton' 2>/dev/null || {
    echo 'error: the site needs the extra docs: pip install -e ".[docs]"' >&2
    exit 2
}
# an earlier site is replaced as a whole, anything else is left alone
if [ -e "$out/.doctrees" ]; then
    rm -rf "$out"
elif [ -n "$(ls -A "$out" 2>/dev/null)" ]; then
    echo "error: $out is not empty and no site of this script" >&2
    exit 2
fi
mkdir -p "$out"
out="$(cd "$out" && pwd)"
"$python" -m sphinx -b html -c docs -d "$out/.doctrees" -W --keep-going -q . "$out"
# the pages lie in docs/, as in the repository; the root leads there
cat >"$out/index.html" <<'END'
<!doctype html>
<html lang="en"><head><meta charset="utf-8"><title>Ship Gym</title>
<meta http-equiv="refresh" content="0; url=docs/index.html"></head>
<body><a href="docs/index.html">Ship Gym</a></body></html>
END
PYTHONPATH=docs "$python" -m website.links "$out"
echo "The site is in $out: open $out/index.html, or serve it by $python -m http.server -d $out"
