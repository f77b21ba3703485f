import pytest
from ship_gym_agents.cli import main


@pytest.fixture
def cli(monkeypatch, tmp_path, capsys):
    """Run ship-gym in this process, in an empty folder: exit code, stdout, stderr."""
    monkeypatch.chdir(tmp_path)

    def call(*arguments):
        code = 0
        try:
            main([*map(str, arguments)])
        except SystemExit as stop:
            code = stop.code or 0
        return code, *capsys.readouterr()

    return call
