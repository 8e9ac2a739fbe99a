"""Numbers of things in findings, grammatical also for one."""


def counted(count: int, noun: str) -> str:
    """`1 space` or `3 spaces`."""
    return f"{count} {noun}" if count == 1 else f"{count} {noun}s"


def are(count: int) -> str:
    """`is` or `are`."""
    return "is" if count == 1 else "are"
