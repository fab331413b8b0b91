from .interference import Interference as Interference
from .pty_bridge import Cable as Cable
from .pty_bridge import PtyBridge as PtyBridge
from .serial_end import Send as Send
from .serial_end import open_serial_end as open_serial_end
from .tcp_bridge import HOST as HOST
from .tcp_bridge import TcpBridge as TcpBridge

__all__ = [
    "HOST",
    "Cable",
    "Interference",
    "PtyBridge",
    "Send",
    "TcpBridge",
    "open_serial_end",
]
