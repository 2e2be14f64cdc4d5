"""HAL files of LinuxCNC: signals by pin, and lines that connect pins."""


def signals(text: str) -> dict[str, str]:
    """Signals of a HAL file, by the pin: a pin is on one signal at most."""
    out: dict[str, str] = {}
    for line in text.splitlines():
        words = line.partition("#")[0].split()
        if words[:1] == ["net"]:
            out |= {pin: words[1] for pin in words[2:] if "." in pin}
    return out


def net(signal: str, source: str, *sinks: str) -> str:
    """Line that connects the pin of a value with those that read it."""
    return f"net {signal} {source} => {' '.join(sinks)}"
