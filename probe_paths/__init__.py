"""From a standard to iTNC 530 probing programs, and from a program's text back to measurements."""
