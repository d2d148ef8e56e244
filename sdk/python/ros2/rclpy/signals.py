"""Handlers of signals. There is no terminal that could send any; the harness ends programs by itself."""

from __future__ import annotations

from rclpy._rclpy_pybind11 import SignalHandlerOptions as SignalHandlerOptions

_options = SignalHandlerOptions.NO


def install_signal_handlers(options: SignalHandlerOptions = SignalHandlerOptions.ALL) -> None:
    """Remembers the options; Python's own handlers stay, so that SIGINT is a KeyboardInterrupt."""
    global _options
    _options = options


def get_current_signal_handlers_options() -> SignalHandlerOptions:
    """The options of the last call."""
    return _options


def uninstall_signal_handlers() -> None:
    """Forgets them."""
    install_signal_handlers(SignalHandlerOptions.NO)
