"""Recordings for the rerun viewer: one per case, all methods inside. Only this package imports rerun."""

from study.recording.animation import moving_picture
from study.recording.case_recording import APPLICATION, record_case
from study.recording.live import LiveRecording, live_recording
from study.recording.notebook import show_in_notebook
from study.recording.offline import forget_pages, interactive_pages
from study.recording.viewer import picture, screenshot, view

__all__ = [
    "APPLICATION",
    "LiveRecording",
    "forget_pages",
    "interactive_pages",
    "live_recording",
    "moving_picture",
    "picture",
    "record_case",
    "screenshot",
    "show_in_notebook",
    "view",
]
