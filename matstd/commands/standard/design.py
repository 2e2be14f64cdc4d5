"""`matstd design`: the main job, from a project file to a folder that proves itself."""

import argparse

from matstd.console import say, say_each
from matstd.options import PDF, SHEET, Options, output
from matstd.progress import Plan, stages
from matstd.workers import SCHEDULER

PLAN: Plan = {
    "reach": 3.9,
    "candidates": 2.6,
    "artefacts of balls": 14.6,
    "faces": 30.0,
    "other artefacts": 8.4,
    "identifiability": 1.7,
    "probing programs": 0.7,
    "proof on the twin": 3.9,
    "visits on the twin": 6.2,
    "maps": 0.1,
    "STEP and STL": 10.8,
    "report": 13.1,
}
"""Seconds of the stages of a design with rotary axes on two idle cores, by the clock, the mean of
four machines (`python benchmarks/progress_estimate.py`). Faces are drawn anew where they do not
fit, one to six times: they count as the longest. The last stages count a tenth more, since a time
left may fall but never rises."""

LINEAR_PLAN = {**PLAN, "artefacts of balls": 5.4, "faces": 3.4}
"""The same without a rotary axis, where a standard has no table poses to choose."""


OPTIONS: Options = {
    "project PROJECT.toml": "project file: machine, blank, workspace, control",
    "--control NAME|FILE.toml": "control that the programs are written for (default: the "
    "project's; see docs/controls.md)",
    **SCHEDULER,
    **PDF,
    **output(),
}


def run(args: argparse.Namespace) -> int:
    """Design, with a bar for every stage; the folder appears whole or not at all."""
    from matstd.api.designing import Project
    from matstd.artefact.reach import standing_remarks
    from matstd.report.machine import swivel_remarks
    from matstd.report.task import fewer_lines, making_lines, task_lines
    from matstd.report.words import design_lines, proof_line

    project = Project.read(args.project, args.control)
    brief = project.brief
    say_each(brief.chain.remarks)
    say_each(brief.remarks)
    say_each(standing_remarks(brief.chain, brief.setup.T_table_artefact, brief.down))
    say_each(swivel_remarks(brief.chain))
    with stages(PLAN if brief.chain.rotary_axes else LINEAR_PLAN) as progress:
        made = project.design(
            args.output, force=args.force, progress=progress, scheduler=args.scheduler, pdf=args.pdf
        )
    built, *others = design_lines(made.placement, brief.ranges)
    say(built, style="bold")
    say_each(others)
    say_each(made.remarks)
    # a pose is visited twice
    dropped = dict.fromkeys(str(r) for one in made.stations for r in one.plan.refused)
    say_each(f"touch dropped: {refusal}" for refusal in dropped)
    tools = {one.dialect.tool for one in made.stations}
    say_each(
        f"tool {tool} has no program: the probes before it make every touch that it reaches"
        for tool in brief.programs.further_tools
        if tool not in tools
    )
    say_each(proof_line(m.seed + 1, m.in_workspace, m.proof, m.fit) for m in made.machines)
    standard, limits = made.placement.standard, brief.blank.limits
    wanted = brief.options.balls
    say_each(fewer_lines(standard, wanted, made.conformity.mass, limits.max_mass))
    say_each(making_lines(made.making))
    say_each(task_lines(made.budgets, brief.task.tolerance, made.visits))
    say(f"{args.output}: look at report.html; {SHEET}/setup.html goes with the programs")
    return 0
