"""The uncertainty of a measuring task in words and rows: for the console and for pages."""

from report.task.task_words import budget_rows, decision_sentence, task_lines

__all__ = ["budget_rows", "decision_sentence", "task_lines"]
