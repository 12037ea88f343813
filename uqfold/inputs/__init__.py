"""Random inputs: distributions of any origin, brought into one ordered joint distribution."""

from uqfold.inputs.joint import JointInputs, joint_inputs, normal, product_inputs

__all__ = ["JointInputs", "joint_inputs", "normal", "product_inputs"]
