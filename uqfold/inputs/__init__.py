"""Random inputs: distributions of any origin, brought into one ordered joint distribution."""

from uqfold.inputs.assembly import joint_inputs, normal, product_inputs
from uqfold.inputs.joint import JointInputs

__all__ = ["JointInputs", "joint_inputs", "normal", "product_inputs"]
