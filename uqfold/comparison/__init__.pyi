from uqfold.comparison.benchmark import benchmark_summary as benchmark_summary
from uqfold.comparison.form import record_schema as record_schema
from uqfold.comparison.frames import (
    checked_frame as checked_frame,
    comparison_header as comparison_header,
)
from uqfold.comparison.header import criteria_of as criteria_of
from uqfold.comparison.named_problems import (
    NamedProblem as NamedProblem,
    available_problems as available_problems,
    named_problem as named_problem,
)
from uqfold.comparison.records import (
    RecordsError as RecordsError,
    read_records as read_records,
    write_records as write_records,
)
from uqfold.comparison.run import compare as compare, run_comparison as run_comparison
