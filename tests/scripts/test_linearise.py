import json

import pytest
from ship_gym_agents.cli import main

from ship_gym import linearise


def test_json_is_the_model(capsys):
    main(["linearise", "--ship", "onrt", "--speed", "5.0", "--json"])
    data = json.loads(capsys.readouterr().out)
    assert data == json.loads(json.dumps(linearise("onrt", 5.0).as_dict()))


def test_text_tells_what_an_autopilot_needs(capsys):
    main(["linearise", "--ship", "kvlcc2"])
    out = capsys.readouterr().out
    model = linearise("kvlcc2")
    assert f"{model.steering.N_delta:.4f}" in out and f"{model.nomoto.K:.5g}" in out
    assert "unstable on a straight course" in out and "rudder 0.55 deg" in out
    assert out.splitlines()[-1] == "next: ship-gym tune --ship kvlcc2"


def test_a_speed_that_cannot_be_held_is_one_line(capsys):
    with pytest.raises(SystemExit) as left:
        main(["linearise", "--ship", "kcs", "--speed", "40"])
    err = capsys.readouterr().err
    assert left.value.code == 2 and "cannot hold 40 m/s" in err and err.count("\n") == 1
