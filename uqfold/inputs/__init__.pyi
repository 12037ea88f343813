from uqfold.inputs.assembly import (
    joint_inputs as joint_inputs,
    normal as normal,
    product_inputs as product_inputs,
)
from uqfold.inputs.data import from_data as from_data
from uqfold.inputs.single_values import (
    bernoulli as bernoulli,
    censored as censored,
    discrete as discrete,
    poisson as poisson,
)
from uqfold.inputs.joint import JointInputs as JointInputs
