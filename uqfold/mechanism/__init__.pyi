from uqfold.mechanism.deployment import (
    DEFAULT_TOLERANCE as DEFAULT_TOLERANCE,
    deployment_times as deployment_times,
)
from uqfold.mechanism.ideal import ideal_deployment_times as ideal_deployment_times
from uqfold.mechanism.parameters import (
    ContactLaw as ContactLaw,
    TangentialVelocity as TangentialVelocity,
    WingParameters as WingParameters,
)
from uqfold.mechanism.recording import Trajectory as Trajectory, trajectory as trajectory
from uqfold.mechanism.tabulation import motion_table as motion_table
