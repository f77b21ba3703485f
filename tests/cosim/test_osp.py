"""libcosim, the master of the Open Simulation Platform, connects two ships by their groups."""

import pytest

pytest.importorskip("pythonfmu")
pytest.importorskip("libcosimpy")

from libcosimpy.CosimExecution import CosimExecution
from libcosimpy.CosimObserver import CosimObserver

from ship_gym.cosim import write_fmu
from ship_gym.cosim.variables import STATES
from ship_gym.sea.state import load_sea
from ship_gym.simulation import ShipSim

# the second ship repeats rudder and propeller of the first
SYSTEM = """<?xml version="1.0" encoding="utf-8"?>
<OspSystemStructure xmlns="http://opensimulationplatform.com/MSMI/OSPSystemStructure" version="0.1">
  <BaseStepSize>0.5</BaseStepSize>
  <Algorithm>fixedStep</Algorithm>
  <Simulators>
    <Simulator name="first" source="first.fmu" stepSize="0.5">
      <InitialValues>
        <InitialValue variable="rudder.command"><Real value="0.3"/></InitialValue>
        <InitialValue variable="sea.name"><String value="ss4"/></InitialValue>
        <InitialValue variable="seed"><Integer value="5"/></InitialValue>
      </InitialValues>
    </Simulator>
    <Simulator name="second" source="second.fmu" stepSize="0.5"/>
  </Simulators>
  <Connections>
    <VariableGroupConnection>
      <VariableGroup simulator="first" name="rudder_angle"/>
      <VariableGroup simulator="second" name="rudder_command"/>
    </VariableGroupConnection>
    <VariableGroupConnection>
      <VariableGroup simulator="first" name="propeller_speed"/>
      <VariableGroup simulator="second" name="propeller_command"/>
    </VariableGroupConnection>
  </Connections>
</OspSystemStructure>
"""


def test_two_ships_are_connected_by_groups_and_have_the_states_of_the_simulation(tmp_path):
    for name in ("first", "second"):
        write_fmu("kcs", tmp_path / f"{name}.fmu")
    (tmp_path / "OspSystemStructure.xml").write_text(SYSTEM, encoding="utf-8")
    execution = CosimExecution.from_osp_config_file(osp_path=str(tmp_path))
    observer = CosimObserver.create_last_value()
    execution.add_observer(observer=observer)
    assert execution.simulate_until(target_time=30_000_000_000)  # [ns]
    sea, calm = ShipSim("kcs", sea=load_sea("ss4")), ShipSim("kcs")
    sea.reset(5)
    calm.reset(0)
    n = float(sea.state[0, 7])
    for _ in range(60):
        repeated = sea.state[0, 6:8].tolist()  # of the start of the step
        sea.step([[0.3, n]], 0.5)
        calm.step([repeated], 0.5)
    for name, sim in (("first", sea), ("second", calm)):
        index = execution.slave_index_from_instance_name(name)
        reference = {v.name.decode(): v.reference for v in execution.slave_variables(index)}
        found = observer.last_real_values(
            slave_index=index, variable_references=[reference[v.name] for v in STATES]
        )
        assert list(found) == sim.state[0].tolist()
