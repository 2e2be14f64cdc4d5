"""Machine files for imported measurements: what the data tell of a machine, to be checked."""

from twin.machine import Chain
from twin.units import DEG


def machine_text(chain: Chain, source: str) -> str:
    """Text of a machine file whose travels are those of some data.

    Args:
        source: What it was made from, for the first line.

    Returns:
        TOML in which everything that the data cannot tell is marked PLACEHOLDER.
    """
    lines = [
        f"# Made from {source}. What is marked PLACEHOLDER the data cannot tell: check it.",
        'format = "machine/1"',
        f'name = "{chain.name}"  # PLACEHOLDER',
        "# PLACEHOLDER: which axes carry the workpiece (a prime) the data cannot tell",
        f'chain = "{chain.notation}"',
    ]
    for axis in chain.programmed_axes:
        link = chain.link(axis)
        unit = 1.0 if link.kind == "linear" else DEG
        low, high = link.range
        lines += [
            "",
            f"[axis.{axis}]",
            f"range = [{low / unit:.12g}, {high / unit:.12g}]  # PLACEHOLDER: that of the data",
        ]
        if link.kind == "rotary":
            x, y, z = (float(v) for v in link.point)
            lines.append(f"point = [{x!r}, {y!r}, {z!r}]  # PLACEHOLDER: a point of its line, mm")
    return "\n".join(lines) + "\n"
