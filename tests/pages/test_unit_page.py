from pages import unit_page


def test_the_page_of_co_simulation_is_current():
    assert not unit_page.outdated(), "run: python scripts/build_docs.py --no-pictures"


def test_every_variable_is_in_a_table():
    made = unit_page.tables()
    assert "`flow.thrust_port`" in made["outputs"] and "`rudder.command`" in made["inputs"]
    assert "`start.latitude`" in made["parameters"] and "| ShaftSpeed |" in made["groups"]
