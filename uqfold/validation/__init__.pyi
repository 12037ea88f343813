from uqfold.validation.findings import (
    VERDICT_RULE as VERDICT_RULE,
    Finding as Finding,
    Verdict as Verdict,
    verdict_of as verdict_of,
)
from uqfold.validation.measurement import (
    Claim as Claim,
    Measurement as Measurement,
    Points as Points,
    Table as Table,
)
from uqfold.validation.record import (
    CaseRecord as CaseRecord,
    RecordError as RecordError,
    read_case_record as read_case_record,
    read_case_records as read_case_records,
    record_schema as record_schema,
)
from uqfold.validation.work import Work as Work
