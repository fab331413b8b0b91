from .catalogue import open_catalogue as open_catalogue
from .catalogue import query as query
from .catalogue import query_table as query_table
from .output import json_rows as json_rows
from .output import write_csv as write_csv
from .output import write_parquet as write_parquet
from .run import LabSummary as LabSummary
from .run import run_lab as run_lab
from .schema import TABLES as TABLES
from .settings import STEPS as STEPS
from .settings import LabSettings as LabSettings
from .steps import find_jobs as find_jobs
from .storage import Lab as Lab
from .task import work_through as work_through

__all__ = [
    "STEPS",
    "TABLES",
    "Lab",
    "LabSettings",
    "LabSummary",
    "find_jobs",
    "json_rows",
    "open_catalogue",
    "query",
    "query_table",
    "run_lab",
    "work_through",
    "write_csv",
    "write_parquet",
]
