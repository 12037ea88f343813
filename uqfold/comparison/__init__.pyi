from uqfold.comparison.benchmark_rows import read_benchmark as read_benchmark
from uqfold.comparison.form import record_schema as record_schema
from uqfold.comparison.frames import (
    checked_frame as checked_frame,
    comparison_header as comparison_header,
)
from uqfold.comparison.header import criteria_of as criteria_of
from uqfold.comparison.league import (
    league_table as league_table,
    problem_scores as problem_scores,
    solving_costs as solving_costs,
)
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
