"""What stands between environment and learner: which features it gets, what its decision does.

numpy only: the same helm serves training and the finished policy.
"""

from ship_gym_agents.forms.form import Form, form_from
from ship_gym_agents.forms.helm import Helm

__all__ = ["Form", "Helm", "form_from"]
