"""How loops are compiled: copies with other kernels, and calls without the search by types."""

import numpy as np
import pytest

from ship_gym.physics import _compiler
from ship_gym.physics._kernel import direct, kernel, specialised


@kernel
def rule(x):
    return x


@kernel
def doubled(x):
    return 2.0 * x


@kernel
def squared(x):
    return x * x


def _sum_of(values):
    total = 0.0
    for i in range(len(values)):
        total += rule(values[i])
    return total


def with_factor(factor):
    @kernel
    def multiplied(x):
        return factor * x

    return multiplied


def test_copies_of_one_loop_call_their_own_kernels():
    values = np.arange(4.0)
    first, second = (specialised(_sum_of, k.__name__, rule=k) for k in (doubled, squared))
    assert first(values) == 12.0 and second(values) == 14.0 and _sum_of(values) == 6.0
    assert first.__name__ != second.__name__ and first.__name__.startswith("doubled_")


def test_kernels_of_one_name_and_other_variables_do_not_share_machine_code():
    values = np.ones(3)
    made = [specialised(_sum_of, "factor", rule=with_factor(k)) for k in (2.0, 3.0)]
    assert [loop(values) for loop in made] == [6.0, 9.0]


def test_a_direct_call_is_the_call_by_types():
    values = np.arange(4.0)
    loop = specialised(_sum_of, "direct", rule=squared)
    call = direct(loop, (values,))
    assert call(values) == loop(values) == 14.0
    assert call(np.ones(7)) == 7.0  # an array of the same type
    values[0] = 3.0
    assert call(values) == 23.0


@pytest.mark.compiled
def test_a_direct_call_refuses_what_is_no_array():
    call = direct(specialised(_sum_of, "refused", rule=squared), (np.zeros(1),))
    with pytest.raises(TypeError):
        call("values")


def test_what_is_not_compiled_is_called_as_it_is():
    def plain(x):
        return x

    assert direct(plain, (1.0,)) is plain


def test_two_files_of_users_with_a_task_of_one_name_do_not_share_machine_code(tmp_path):
    from ship_gym.own_files import load_file

    values, found = np.arange(4.0), []
    for folder, body in (("one", "2.0 * x"), ("two", "3.0 * x")):
        (tmp_path / folder).mkdir()
        file = tmp_path / folder / "mine.py"
        file.write_text(
            "from ship_gym.physics._kernel import kernel\n\n\n"
            f"@kernel\ndef mine(x):\n    return {body}\n"
        )
        found.append(specialised(_sum_of, "user", rule=load_file(file).mine))
    assert [loop(values) for loop in found] == [12.0, 18.0]
    assert found[0].__name__ != found[1].__name__


def test_an_edited_file_of_a_user_is_compiled_again(tmp_path):
    from ship_gym.own_files import load_file

    values, file = np.arange(4.0), tmp_path / "mine.py"
    for factor, total in ((2.0, 12.0), (33.0, 198.0)):
        file.write_text(
            "from ship_gym.physics._kernel import kernel\n\n\n"
            f"@kernel\ndef mine(x):\n    return {factor} * x\n"
        )
        assert specialised(_sum_of, "user", rule=load_file(file).mine)(values) == total


@pytest.mark.compiled
def test_a_numba_that_is_made_otherwise_is_noticed_and_compiles_the_plain_way(monkeypatch):
    """The loop calls a kernel with a variable around it, so that its code is not kept."""

    def other(library):
        raise TypeError("not enough values to unpack")

    assert _compiler.works()
    monkeypatch.setattr(_compiler, "_simplify", other)
    with pytest.raises(TypeError, match="unpack"):
        specialised(_sum_of, "ours", rule=with_factor(5.0))(np.ones(3))
    monkeypatch.setattr(_compiler, "_found", None)
    assert specialised(_sum_of, "plain", rule=with_factor(5.0))(np.ones(3)) == 15.0
    assert _compiler._found is False


@pytest.mark.compiled
def test_a_numba_that_compiles_our_ways_wrongly_is_noticed(monkeypatch):
    monkeypatch.setattr(_compiler, "_found", None)
    monkeypatch.setattr(_compiler, "_tried_loop", lambda: lambda values: values.sum())
    assert not _compiler.works()
