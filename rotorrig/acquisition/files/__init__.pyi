from .file_kind import KINDS as KINDS
from .file_kind import LAB_CSV as LAB_CSV
from .file_kind import LAB_PARQUET as LAB_PARQUET
from .file_kind import content_kind as content_kind
from .file_kind import is_mcap as is_mcap
from .file_kind import read_file_kind as read_file_kind
from .file_kind import read_source_hash as read_source_hash
from .foxglove_schemas import INFO as INFO
from .foxglove_schemas import LOG as LOG
from .foxglove_schemas import POINT_CLOUD as POINT_CLOUD
from .foxglove_schemas import WARNING as WARNING
from .foxglove_schemas import cloud_values as cloud_values
from .foxglove_schemas import log_values as log_values
from .part_file import part_path as part_path
from .part_file import refuse_leftover as refuse_leftover
from .recording_mcap import Contents as Contents
from .recording_mcap import FileKind as FileKind
from .recording_mcap import FileWriter as FileWriter
from .recording_mcap import RecordingWriter as RecordingWriter
from .recording_mcap import open_recording as open_recording
from .recording_mcap import read_file as read_file
from .recording_mcap import read_recording as read_recording
from .recording_mcap import salvage as salvage
from .recording_mcap import write_recording as write_recording
from .schemas import MessageType as MessageType
from .schemas import message_type as message_type

__all__ = [
    "INFO",
    "KINDS",
    "LAB_CSV",
    "LAB_PARQUET",
    "LOG",
    "POINT_CLOUD",
    "WARNING",
    "Contents",
    "FileKind",
    "FileWriter",
    "MessageType",
    "RecordingWriter",
    "cloud_values",
    "content_kind",
    "is_mcap",
    "log_values",
    "message_type",
    "open_recording",
    "part_path",
    "read_file",
    "read_file_kind",
    "read_recording",
    "read_source_hash",
    "refuse_leftover",
    "salvage",
    "write_recording",
]
